// The page of a walk in a real browser: the biped is drawn where the walk has it, its passive hips in their colour, moves with slider and play, and
// nothing fails or is fetched.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/walk/simulation.hpp"
#include "host/walk/walk_report.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/skip.hpp"
#include "tests/web/browser.hpp"

namespace furcula {
namespace {

constexpr const char* kProbe = R"(<script>
(async function () {
  const canvas = get('walk-canvas');
  const picture = () => pictureOf(canvas);
  const orange = () => {
    let n = 0;
    const p = pixelsOf(canvas);
    for (let i = 0; i < p.length; i += 4)
      if (p[i + 3] > 128 && Math.abs(p[i] - 230) < 12 && Math.abs(p[i + 1] - 159) < 12 && p[i + 2] < 40) ++n;
    return n;
  };
  const seen = {length: Number(get('walk-slider').max), start: picture()};
  seen.moment = window.furculaWalk.at(4);
  seen.walking = picture();
  seen.orange = orange();
  const slider = get('walk-slider');
  slider.value = 0;
  slider.oninput();
  await wait(100);
  seen.back = picture();
  get('walk-play').click();
  seen.playing = get('walk-play').textContent;
  await wait(400);
  get('walk-play').click();
  seen.paused = get('walk-play').textContent;
  seen.played = Number(slider.value);
  const turn = window.furculaWalk.view().turn;
  canvas.dispatchEvent(new PointerEvent('pointerdown', {clientX: 100, clientY: 100, pointerId: 1}));
  canvas.dispatchEvent(new PointerEvent('pointermove', {clientX: 200, clientY: 100, pointerId: 1}));
  seen.turned = turn - window.furculaWalk.view().turn;
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

TEST_CASE("the biped of a walk is drawn, its passive hips orange, and moves with slider and play") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  const walk::Model model = walk::read_model(test::source("models/biped/biped.toml"));
  for (const char* mode : {"active", "semi_passive"}) {
    const walk::Walk walk = test::found_walk(mode);
    walk::RolloutOptions options;
    options.mode = walk.mode;
    const walk::Rollout rollout = walk::run_walk(model.robot, options, walk.parameters);
    const std::vector<walk::SearchPoint> history{
        {1.0, 1000, 10, 1.5, 0.0}, {2.0, 2000, 20, 0.9, 9.0}, {3.0, 3000, 30, 0.8, 4.0}};
    std::string page = walk::render_walk_report(model, options, walk.parameters, rollout, history,
                                                std::nullopt, "furcula walk");
    page.insert(page.find("<meta name=\"viewport\""), test::kFrames);
    const int width = walk.mode == walk::WalkMode::active ? 1400 : 500;
    std::string script = test::kPictureTools;
    script += kProbe;
    const nlohmann::json seen = test::look_at(*browser, page, script, width);
    INFO(seen.dump(1));
    CHECK(seen["problems"].empty());
    CHECK(seen["fetched"].empty());
    CHECK(seen["length"].get<double>() == Approx(rollout.time_s).margin(0.03));
    CHECK(seen["walking"] != seen["start"]);
    CHECK(seen["back"] == seen["start"]);
    CHECK((seen["orange"].get<int>() > 20) == (walk.mode == walk::WalkMode::semi_passive));
    CHECK(seen["playing"] == "Pause");
    CHECK(seen["paused"] == "Play");
    CHECK(seen["played"].get<double>() > 0.1);
    CHECK(seen["turned"].get<double>() == Approx(0.8).margin(1e-9));
    CHECK(seen["plots"] == 7);
    CHECK(seen["page_width"] <= width);
    // The pelvis where the simulation has it; a foot stands on the ground and carries: on a single corner it sinks by a centimetre.
    const auto log = walk::simulate_walk(model.robot, options, walk.parameters, 0.001, std::nullopt).log;
    const auto& m = seen["moment"];
    CHECK(m["points"][0][2].get<double>() == Approx(log.at("base_z_m")[4000]).margin(2e-3));
    double lowest = 1.0;
    for (const auto& p : m["points"]) lowest = std::min(lowest, p[2].get<double>());
    CHECK(lowest < 0.0);
    CHECK(lowest > -0.015);
    CHECK(m["force"][2].get<double>() + m["force"][5].get<double>() > 200.0);
  }
}

}  // namespace
}  // namespace furcula
