// The report in a real browser: the plots have data and can be moved, nothing fails, nothing is fetched, it
// prints.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "tests/host/report/sample.hpp"
#include "tests/skip.hpp"
#include "tests/web/browser.hpp"

namespace furcula {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::string read(const fs::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

/// Looks at the page when it has drawn, uses its controls, and leaves what it saw in <pre id="seen">.
constexpr const char* kProbe = R"(<script>
setTimeout(function () {
  // Pixels of the canvas that are neither transparent nor of the grid's or background's pale colours.
  function ink(id) {
    let n = 0;
    for (const canvas of document.querySelectorAll('#' + id + ' canvas')) {
      if (!canvas.width || !canvas.height) continue;
      const p = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
      for (let i = 0; i < p.length; i += 4) if (p[i + 3] > 128 && Math.min(p[i], p[i + 1], p[i + 2]) < 200) ++n;
    }
    return n;
  }
  const get = id => document.getElementById(id);
  const ticks = id => [...document.querySelectorAll('#' + id + ' .dygraph-axis-label-x')].map(e => e.textContent);
  const seen = {};
  const has = get('trace-plot') !== null;
  if (has) {
    seen.ink = {trace: ink('trace-plot'), error: ink('error-plot')};
    seen.points = JSON.parse(get('trace-data').textContent).series.map(s => s.time.length);
    seen.logs = get('pick-log').options.length;
    seen.windows = get('pick-window').options.length;
    seen.caption = get('trace-caption').textContent;
    seen.legend = [...document.querySelectorAll('#trace-legend button')].map(b => b.textContent);
    seen.ticks = ticks('trace-plot');
    get('window-after').click();
    seen.ticks_zoomed = ticks('trace-plot');
    seen.error_ticks_zoomed = ticks('error-plot');
    seen.ink_zoomed = {trace: ink('trace-plot'), error: ink('error-plot')};
    get('window-before').click();
    seen.ticks_back = ticks('trace-plot');
    document.querySelectorAll('#trace-legend button')[0].click();
    seen.ink_hidden = ink('trace-plot');
    document.querySelectorAll('#trace-legend button')[0].click();
    get('pick-channel').value = get('pick-channel').options.length - 1;
    get('pick-channel').onchange();
    seen.ink_channel = ink('trace-plot');
    seen.ylabel = document.querySelector('#trace-plot .dygraph-ylabel').textContent;
    dispatchEvent(new Event('beforeprint'));
    seen.print_width = document.querySelector('#trace-plot canvas').getBoundingClientRect().width;
    seen.ink_print = ink('trace-plot');
    dispatchEvent(new Event('afterprint'));
    seen.screen_width = document.querySelector('#trace-plot canvas').getBoundingClientRect().width;
    seen.box_width = get('trace-plot').getBoundingClientRect().width;
  }
  seen.svg_points = [...document.querySelectorAll('.cloud')].map(c => c.getAttribute('d').split('M').length - 1);
  seen.svg_laws = [...document.querySelectorAll('.law')].map(l => l.getBBox().width > 100 && l.getBBox().height > 10);
  seen.images = document.images.length;
  seen.fetched = performance.getEntriesByType('resource').map(r => r.name);
  seen.page_width = document.documentElement.scrollWidth;
  seen.view_width = innerWidth;
  seen.problems = problems;
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = JSON.stringify(seen);
  document.body.appendChild(out);
}, 500);
</script>)";

nlohmann::json look_at(const test::Browser& browser, const std::string& page, int width = 1400) {
  return test::look_at(browser, page, kProbe, width);
}

TEST_CASE("the report's plots have data, follow their controls, and need no network") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  const diagnose::Diagnosis d = test::sample_diagnosis();
  const nlohmann::json seen = look_at(*browser, test::page_of(d));
  INFO(seen.dump(1));
  CHECK(seen["problems"].empty());
  CHECK(seen["fetched"].empty());
  CHECK(seen["images"] == 0);

  std::size_t samples = 0, shown = 0;
  for (const diagnose::Trace& t : d.traces) samples += t.time_s.size();
  for (const auto& n : seen["points"]) shown += n.get<std::size_t>();
  CHECK(shown == samples);
  CHECK(seen["logs"] == 3);
  CHECK(seen["caption"] == "drop-04.csv");
  CHECK(seen["legend"] == nlohmann::json({"measured", "as given", "re-fitted", "extended"}));

  // A line across the plot is some thousand pixels; a blank plot has none.
  CHECK(seen["ink"]["trace"] > 3000);
  CHECK(seen["ink"]["error"] > 3000);
  CHECK(seen["ink_hidden"] < seen["ink"]["trace"]);
  CHECK(seen["ink_channel"] > 3000);
  CHECK(seen["ylabel"] == "Velocity (m/s)");

  // Zoomed to a window both plots show the same stretch; stepping back shows all again.
  CHECK(seen["ticks_zoomed"] != seen["ticks"]);
  CHECK(seen["ticks_zoomed"] == seen["error_ticks_zoomed"]);
  CHECK(seen["ticks_back"] == seen["ticks"]);
  CHECK(seen["ink_zoomed"]["trace"] > 3000);
  CHECK(seen["ink_zoomed"]["error"] > 3000);

  // The plots take the paper's width for printing and the screen's again afterwards.
  CHECK(seen["print_width"] <= 660);
  CHECK(seen["ink_print"] > 2000);
  CHECK(seen["screen_width"] == seen["box_width"]);
  CHECK(seen["screen_width"] > 900);

  REQUIRE(seen["svg_points"].size() == 3);
  for (const auto& n : seen["svg_points"]) CHECK(n > 300);
  CHECK(seen["svg_laws"] == nlohmann::json({true, true, true}));
}

TEST_CASE("the report fits a narrow screen without scrolling sideways") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  const nlohmann::json seen = look_at(*browser, test::page_of(test::sample_diagnosis(8, 4)), 500);
  INFO(seen.dump(1));
  CHECK(seen["view_width"] <= 500);
  CHECK(seen["page_width"] <= seen["view_width"]);
  CHECK(seen["problems"].empty());
}

TEST_CASE("hostile names of files and channels run nothing in the browser") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  diagnose::Diagnosis d = test::sample_diagnosis(4, 3);
  const std::string hostile = "</script><img src=x onerror=\"throw 'ran'\">\xE2\x80\xA8'\"<!--";
  d.summary = hostile;
  d.held_out_files = {hostile};
  for (diagnose::Trace& t : d.traces) {
    t.log = hostile;
    t.unit = t.channel = hostile;
  }
  const nlohmann::json seen = look_at(*browser, test::page_of(d));
  INFO(seen.dump(1));
  CHECK(seen["problems"].empty());
  CHECK(seen["images"] == 0);
  CHECK(seen["caption"] == hostile);
  CHECK(seen["ink"]["trace"] > 1000);
}

TEST_CASE("a report without traces runs without a problem") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  const nlohmann::json seen = look_at(*browser, test::page_of(diagnose::Diagnosis{}));
  CHECK(seen["problems"].empty());
  CHECK(seen["svg_points"].empty());
}

TEST_CASE("the report prints on a few pages") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  const test::TemporaryFolder folder;
  write(folder.path() / "report.html", test::page_of(test::sample_diagnosis()));
  browser->print(folder.path() / "report.html", folder.path() / "report.pdf");
  const std::string pdf = read(folder.path() / "report.pdf");
  REQUIRE(pdf.starts_with("%PDF-"));
  const std::regex page("/Type\\s*/Page[^s]");
  const auto pages =
      std::distance(std::sregex_iterator(pdf.begin(), pdf.end(), page), std::sregex_iterator());
  CHECK(pages >= 3);
  CHECK(pages <= 9);
  CHECK(pdf.size() > 50'000);
}

}  // namespace
}  // namespace furcula
