// The page of a loop in a real browser: marks of the triangle are visible where they belong, links stay in the loop's folder, and nothing fails or
// is fetched.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/host/loop/sample_loop.hpp"
#include "tests/skip.hpp"
#include "tests/web/browser.hpp"

namespace furcula {
namespace {

constexpr const char* kProbe = R"(<script>
(function () {
  const tables = [...document.querySelectorAll('#triangle table')];
  const rows = [...tables[0].querySelectorAll('tbody tr')];
  const seen = {tables: tables.length};
  seen.trials = [...tables[0].querySelectorAll('th')].slice(1).map(h => h.textContent);
  seen.models = rows.map(r => r.cells[0].textContent);
  seen.numbers = rows.map(r => [...r.cells].slice(1).map(c => c.textContent));
  const marked = (of) => rows.map(r => [...r.cells].slice(1).map(c => {
    const cell = c.querySelector('.cell');
    return cell !== null && of(getComputedStyle(cell)) ? 1 : 0;
  }));
  seen.green = marked(s => s.backgroundColor === 'rgb(205, 235, 217)');
  seen.framed = marked(s => s.borderTopColor === 'rgb(0, 114, 178)');
  seen.links = [...document.querySelectorAll('a')].map(a => a.getAttribute('href'));
  document.querySelector('details').open = true;
  seen.plots = document.querySelectorAll('#over-rounds svg').length;
  seen.dots = document.querySelectorAll('#over-rounds circle').length;
  seen.sections = [...document.querySelectorAll('section')].map(s => s.id);
  seen.bold = document.querySelectorAll('b').length;
  seen.fetched = performance.getEntriesByType('resource').map(r => r.name);
  seen.page_width = document.documentElement.scrollWidth;
  seen.problems = problems;
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = JSON.stringify(seen);
  document.body.appendChild(out);
})();
</script>)";

TEST_CASE("the triangle of a loop marks training and trials that stood, and links lead to its files") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  loop::LoopOptions options;
  options.model = "model<b>.toml";
  options.walk = "walk.toml";
  options.robot = "./try {walk} {log}";
  options.out = "loop";
  const std::string page = loop::render_loop_report("furcula<b>biped</b>", options, test::sample_loop());
  for (const int width : {1400, 500}) {
    const nlohmann::json seen = test::look_at(*browser, page, kProbe, width);
    INFO(seen.dump(1));
    CHECK(seen["problems"].empty());
    CHECK(seen["fetched"].empty());
    CHECK(seen["bold"] == 0);
    CHECK(seen["page_width"] <= width);
    CHECK(seen["sections"] == nlohmann::json{"answer", "triangle", "over-rounds", "rounds"});
    CHECK(seen["tables"] == 5);
    CHECK(seen["models"] == nlohmann::json{"As given", "Identified from the exercise",
                                           "Identified after round 1", "Identified after round 2"});
    CHECK(seen["trials"] == nlohmann::json{"Round 1, trial 1", "Round 1, trial 2", "Round 2, trial 1",
                                           "Round 2, trial 2", "Round 3, trial 1", "Round 3, trial 2"});
    CHECK(seen["numbers"] == nlohmann::json{{"111", "112", "121", "122", "131", "132"},
                                            {"511", "512", "", "", "", ""},
                                            {"211", "212", "221", "222", "", ""},
                                            {"311", "312", "321", "322", "331", "332"}});
    CHECK(seen["green"] ==
          nlohmann::json{{0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0}, {1, 1, 0, 0, 0, 0}, {1, 1, 1, 1, 0, 0}});
    CHECK(seen["framed"] ==
          nlohmann::json{{0, 0, 0, 1, 1, 1}, {0, 0, 0, 0, 0, 0}, {0, 0, 0, 1, 0, 0}, {0, 0, 0, 1, 1, 1}});
    CHECK(seen["plots"] == 2);
    CHECK(seen["dots"] == 6);
    // Models, walks, searches, identifications, logs of walks and of the exercise.
    CHECK(seen["links"].size() == 3 + 3 + 3 + 3 + 6 + 1);
    for (const auto& link : seen["links"]) CHECK(link.get<std::string>().starts_with("round_"));
  }
}

}  // namespace
}  // namespace furcula
