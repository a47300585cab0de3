// The page of a robot of several joints in a real browser: the robot is drawn where its joints put it, moves with slider and
// play, turns and zooms, and nothing fails or is fetched.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "furcula/dynamics/tree/energy.hpp"
#include "tests/host/report/tree_sample.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"
#include "tests/web/browser.hpp"

namespace furcula {
namespace {

/// Uses the controls one after the other and keeps a checksum of the picture after each.
constexpr const char* kProbe = R"(<script>
(async function () {
  const canvas = get('robot-canvas');
  const pixels = () => pixelsOf(canvas);
  const frame = () => new Promise(done => requestAnimationFrame(done));
  const picture = async () => {
    await frame();
    await frame();
    return pictureOf(canvas);
  };
  // Pixels near a colour, in a picture whose lines lie over each other.
  const near = (r, g, b) => {
    let n = 0;
    const p = pixels();
    for (let i = 0; i < p.length; i += 4)
      if (p[i + 3] > 128 && Math.abs(p[i] - r) + Math.abs(p[i + 1] - g) + Math.abs(p[i + 2] - b) < 90) ++n;
    return n;
  };
  const key = k => canvas.dispatchEvent(new KeyboardEvent('keydown', {key: k, bubbles: true, cancelable: true}));
  const seen = {moves: get('robot-slider') !== null};
  await wait(300);
  seen.pictures = {start: await picture()};
  const colours = new Set();
  const p = pixels();
  for (let i = 0; i < p.length; i += 4) colours.add((p[i] << 16) | (p[i + 1] << 8) | p[i + 2]);
  seen.colours = colours.size;
  seen.pose = window.furculaRobot.pose(window.positions || [0.3, -0.7]);
  key('ArrowLeft');
  seen.pictures.turned = await picture();
  key('+');
  seen.pictures.zoomed = await picture();
  for (const [type, x] of [['pointerdown', 100], ['pointermove', 160], ['pointerup', 160]])
    canvas.dispatchEvent(new PointerEvent(type, {pointerId: 1, clientX: x, clientY: 50}));
  seen.pictures.dragged = await picture();
  get('robot-home').click();
  seen.pictures.home = await picture();
  get('robot-names').click();
  seen.pictures.names = await picture();
  get('robot-names').click();
  if (seen.moves) {
    seen.orange = near(213, 94, 0);
    seen.logs = [...get('robot-log').options].map(o => o.textContent);
    get('robot-slider').value = 1.5;
    get('robot-slider').oninput();
    seen.pictures.later = await picture();
    seen.time = get('robot-time').textContent;
    seen.difference = get('robot-difference').textContent;
    for (const mode of ['measured', 'simulated', 'beside']) {
      get('robot-mode').value = mode;
      get('robot-mode').onchange();
      seen.pictures[mode] = await picture();
      seen['grey_' + mode] = near(91, 104, 117);
      seen['blue_' + mode] = near(0, 114, 178);
    }
    const before = Number(get('robot-slider').value);
    get('robot-play').click();
    seen.button_playing = get('robot-play').textContent;
    await wait(400);
    get('robot-play').click();
    seen.button_paused = get('robot-play').textContent;
    seen.pictures.played = await picture();
    seen.advanced = Number(get('robot-slider').value) - before;
    await frame();
    await frame();
    seen.stayed = Number(get('robot-slider').value) - before === seen.advanced;
  }
  seen.fetched = performance.getEntriesByType('resource').map(r => r.name);
  seen.images = document.images.length;
  seen.page_width = document.documentElement.scrollWidth;
  seen.view_width = innerWidth;
  seen.problems = problems;
  const out = document.createElement('pre');
  out.id = 'seen';
  out.textContent = JSON.stringify(seen);
  document.body.appendChild(out);
})();
</script>)";

nlohmann::json look_at(const test::Browser& browser, const trees::Diagnosis& d, const std::string& probe,
                       int width = 1400) {
  std::string page = test::page_of(d);
  page.insert(page.find("<meta name=\"viewport\""), test::kFrames);
  return test::look_at(browser, page, test::kPictureTools + probe, width);
}

TEST_CASE("the robot is drawn, moves with slider and play, turns and zooms, and needs no network") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  const nlohmann::json seen = look_at(*browser, test::sample_tree_diagnosis(), kProbe);
  INFO(seen.dump(1));
  CHECK(seen["problems"].empty());
  CHECK(seen["fetched"].empty());
  CHECK(seen["images"] == 0);
  CHECK(seen["colours"] > 50);
  CHECK(seen["orange"] > 300);  // where the causes sit

  const auto& picture = seen["pictures"];
  CHECK(picture["turned"] != picture["start"]);
  CHECK(picture["zoomed"] != picture["turned"]);
  CHECK(picture["dragged"] != picture["zoomed"]);
  CHECK(picture["home"] == picture["start"]);
  CHECK(picture["names"] != picture["home"]);
  CHECK(picture["later"] != picture["home"]);
  CHECK(picture["played"] != picture["beside"]);

  // 7 * 1.5 rad into a sine of 20 mrad: 20 |sin 10.5| = 17.6 mrad, of both joints.
  CHECK(seen["logs"] == nlohmann::json({"log-06.csv", "log-07.csv"}));
  CHECK(seen["time"].get<std::string>().starts_with("1.5"));
  CHECK(seen["difference"].get<std::string>().find(", 17.6 mrad") != std::string::npos);
  CHECK(seen["grey_measured"] > 300);
  CHECK(seen["blue_measured"] < 200);  // the world's z axis
  CHECK(seen["blue_simulated"] > 300);
  CHECK(seen["blue_beside"] > 100);
  CHECK(seen["grey_beside"] > 100);

  CHECK(seen["button_playing"] == "Pause");
  CHECK(seen["button_paused"] == "Play");
  CHECK(seen["advanced"] > 0.2);  // of 0.4 s at speed 1, less than two frames
  CHECK(seen["advanced"] < 0.5);
  CHECK(seen["stayed"] == true);
}

TEST_CASE("the page's joints put each link where the tree has it") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  trees::Diagnosis d;
  d.model.urdf = model::read_urdf(test::source("tests/host/model/robots/branched.urdf"));
  d.model.robot = model::tree_of(d.model.urdf);
  d.model.drives.resize(d.model.joints());
  const std::vector<double> positions{0.3, -0.7, 1.1, 0.05, -0.4, 0.9, -0.08};
  REQUIRE(positions.size() == d.model.joints());
  const std::string probe = "<script>positions = " + nlohmann::json(positions).dump() + ";</script>" + kProbe;
  const nlohmann::json seen = look_at(*browser, d, probe);
  INFO(seen.dump(1));
  CHECK(seen["problems"].empty());
  CHECK(seen["moves"] == false);
  CHECK(seen["colours"] > 20);

  model::RobotModel::Joints q{};
  std::copy(positions.begin(), positions.end(), q.begin());
  const auto frames = dynamics::tree::link_frames(d.model.robot.model, q);
  REQUIRE(seen["pose"].size() == positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto& f = frames[i];
    // The page has the turn back, by rows.
    const double turn[9] = {f.turn.x.x, f.turn.y.x, f.turn.z.x, f.turn.x.y, f.turn.y.y,
                            f.turn.z.y, f.turn.x.z, f.turn.y.z, f.turn.z.z};
    for (std::size_t k = 0; k < 9; ++k)
      CHECK(seen["pose"][i]["turn"][k].get<double>() == Approx(turn[k]).margin(1e-9));
    CHECK(seen["pose"][i]["at"][0].get<double>() == Approx(f.at.x).margin(1e-9));
    CHECK(seen["pose"][i]["at"][1].get<double>() == Approx(f.at.y).margin(1e-9));
    CHECK(seen["pose"][i]["at"][2].get<double>() == Approx(f.at.z).margin(1e-9));
  }
}

TEST_CASE("the page of a tree fits a narrow screen, and hostile names run nothing") {
  const auto browser = test::Browser::find();
  if (!browser) return test::skip(test::kNoBrowser);
  trees::Diagnosis d = test::sample_tree_diagnosis();
  const std::string hostile = "</script><img src=x onerror=\"throw 'ran'\">\xE2\x80\xA8'\"<!--";
  d.summary = hostile;
  d.motions[0].log = hostile;
  d.model.robot.joints[1].name = hostile;
  const nlohmann::json seen = look_at(*browser, d, kProbe, 500);
  INFO(seen.dump(1));
  CHECK(seen["problems"].empty());
  CHECK(seen["images"] == 0);
  CHECK(seen["logs"][0] == hostile);
  CHECK(seen["view_width"] <= 500);
  CHECK(seen["page_width"] <= seen["view_width"]);
  CHECK(seen["pictures"]["later"] != seen["pictures"]["home"]);
}

}  // namespace
}  // namespace furcula
