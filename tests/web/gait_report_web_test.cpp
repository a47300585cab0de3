// The page of a gait in a real browser: the leg is drawn where the gait has it, its spring in its colour, moves with slider
// and play, and nothing fails or is fetched.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "host/gait/gait_report.hpp"
#include "tests/host/gait/legs.hpp"
#include "tests/skip.hpp"
#include "tests/web/browser.hpp"

namespace furcula {
namespace {

constexpr const char* kProbe = R"(<script>
(async function () {
  const canvas = get('leg-canvas'), slider = get('leg-slider');
  const picture = () => pictureOf(canvas);
  // Pixels between the spring's grey and its orange, nearer to orange.
  const orange = () => {
    let n = 0;
    const p = pixelsOf(canvas);
    for (let i = 0; i < p.length; i += 4)
      if (p[i + 3] > 128 && p[i] > 175 && p[i + 1] < 135 && p[i + 2] < 90) ++n;
    return n;
  };
  const seen = {length: Number(slider.max), start: picture()};
  slider.value = flight;
  slider.oninput();
  seen.flight_orange = orange();
  seen.flight = picture();
  slider.value = stance;
  slider.oninput();
  seen.stance_orange = orange();
  seen.stance = picture();
  seen.pose = window.furculaLeg.pose(stance);
  seen.time = get('leg-time').textContent;
  get('leg-play').click();
  seen.playing = get('leg-play').textContent;
  await wait(400);
  get('leg-play').click();
  seen.paused = get('leg-play').textContent;
  seen.played = picture();
  seen.plots = document.querySelectorAll('svg').length;
  seen.fetched = performance.getEntriesByType('resource').map(r => r.name);
  seen.page_width = document.documentElement.scrollWidth;
  seen.problems = problems;
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = JSON.stringify(seen);
  document.body.appendChild(out);
})();
</script>)";

TEST_CASE("the leg of a gait is drawn, its spring orange in stance alone, and moves with slider and play") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  const gait::Search found = test::found(gait::LegSpring::switched, test::in_place(0.075));
  REQUIRE(found.gait);
  const std::vector<gait::Moment> moments = gait::moments_of(*found.gait);
  const auto most = std::max_element(moments.begin(), moments.end(), [](const auto& a, const auto& b) {
    return std::abs(a.spring_nm) < std::abs(b.spring_nm);
  });
  std::string page =
      gait::render_gait_report(found, {gait::stability_of(*found.gait), {}, {}, {}, {}}, "furcula gait");
  page.insert(page.find("<meta name=\"viewport\""), test::kFrames);
  const std::string times =
      "<script>var flight = 0.05, stance = " + std::to_string(most->time_s) + ";</script>";
  for (const int width : {1400, 500}) {
    const nlohmann::json seen = test::look_at(*browser, page, test::kPictureTools + times + kProbe, width);
    INFO(seen.dump(1));
    CHECK(seen["problems"].empty());
    CHECK(seen["fetched"].empty());
    CHECK(seen["length"].get<double>() == Approx(found.evaluation.stride_s).margin(1e-4));
    CHECK(seen["flight"] != seen["start"]);
    CHECK(seen["flight_orange"] == 0);
    CHECK(seen["stance_orange"] > 50);
    // Hip and toe where the integrator has them; the toe stands.
    CHECK(seen["pose"][2].get<double>() == Approx(most->hip.y).margin(1e-4));
    CHECK(seen["pose"][6].get<double>() == Approx(0.0).margin(1e-4));
    CHECK(seen["playing"] == "Pause");
    CHECK(seen["paused"] == "Play");
    CHECK(seen["played"] != seen["stance"]);
    CHECK(seen["plots"] == 6);
    CHECK(seen["page_width"] <= width);
  }
}

}  // namespace
}  // namespace furcula
