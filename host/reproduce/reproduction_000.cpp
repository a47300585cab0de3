#include "host/reproduce/reproduction_000.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "furcula/dynamics/biped/design.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/report/html.hpp"
#include "host/report/line_plot.hpp"
#include "host/report/page.hpp"
#include "host/reproduce/rows.hpp"
#include "host/walk/search.hpp"
#include "host/walk/walk_report.hpp"

namespace furcula::reproduce {
namespace {

using report::number;
using walk::WalkMode;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kDay_s = 86400.0, kTheirThreads = 7.0;

walk::RolloutOptions rollout_of(const walk::Model& model, WalkMode mode) {
  walk::RolloutOptions o;
  o.mode = mode;
  o.limits = model.limits;
  return o;
}

std::string name_of(WalkMode mode) { return walk::mode_in_words(mode); }

PinIn pin_of_hip() {
  using Clutch = dynamics::PinClutchJoint<double>;
  constexpr auto design = dynamics::biped::design();
  constexpr double kTick_s = 1e-3, kLetGo_rad = 0.5;
  auto p = dynamics::biped_hip<double>();
  p.spring_rest_rad = 0.0;
  PinIn out;
  const auto& drive = design.drives[0][dynamics::biped::kHipPitch];
  Clutch clutch(p);
  clutch.reset(kLetGo_rad, 0.0);
  const auto follow = [&](double pin) {
    clutch.advance(
        drive.kp_nmprad * (clutch.link_rad() - clutch.rotor_rad()) - drive.kd_nmsprad * clutch.rotor_radps(),
        pin, kTick_s);
  };
  // The servo starts where the link swings through.
  double turned = clutch.link_rad();
  while (clutch.link_rad() > 0.0) follow(0.0);
  while (clutch.link_radps() < 0.0) {
    follow(0.0);
    turned = clutch.link_rad();
  }
  out.back_open = -turned / kLetGo_rad;
  while (clutch.link_rad() < 0.0) follow(0.0);
  while (clutch.pin() < 1.0 && out.time_s < 1.0) {
    follow(1.0);
    out.time_s += kTick_s;
    out.apart_rad = std::max(out.apart_rad, std::abs(clutch.link_rad() - clutch.rotor_rad()));
  }
  Clutch joined(p);
  joined.reset(0.0, 0.0);
  while (joined.pin() < 1.0) joined.advance(0.0, 1.0, kTick_s);
  joined.set_link(kLetGo_rad, 0.0);
  joined.set_rotor(kLetGo_rad, 0.0);
  double lowest = kLetGo_rad;
  for (int k = 0; k < 5000; ++k) {
    joined.advance(0.0, 1.0, kTick_s);
    lowest = std::min(lowest, joined.link_rad());
  }
  out.back_joined = std::max(0.0, -lowest) / kLetGo_rad;
  return out;
}

std::vector<Omission> omissions_of_000(bool loops) {
  using enum Because;
  std::vector<Omission> out{
      {"I", "hip with 3 joints, knee 1, ankle 2; range +-1.57 rad; gear 160; 220 N m", put_in,
       "The robot's model."},
      {"II", "a pin whose yield stress is 10 times its largest stress", drawing,
       "Its diameter and material are not printed."},
      {"II", "56.6 W, 134 mm, 83 mm of a tooth clutch; 300 N m of JAXON", other_work, "Of other machines."},
      {"III", "maximum torque 80 N m, 1.5 rad/s, 50 N m, 80 cm, 10 s", put_in, "The limits of the search."},
      {"Fig. 5", "snapshots", drawing, "The walks' own pages have the robot walking."},
      {"Fig. 9", "snapshots and hip roll angles of robot and simulation", drawing,
       "Pages of identifications have them."},
      {"Fig. 10", "power of the real robot over time", recording, "Of the document's robot."},
  };
  if (!loops)
    out.push_back({"IV", "errors of identification, Figs. 7 and 8; 259e-3 rad", not_computed,
                   "No --loop is given; `furcula walk loop` makes its folder."});
  return out;
}

const walk::EnergyCase& case_of(const StudiedWalk& w, std::string_view what) {
  return *std::find_if(w.cases.begin(), w.cases.end(),
                       [&](const walk::EnergyCase& c) { return c.what == what; });
}

void add_rows(WalkReproduction& r) {
  auto& rows = r.rows;
  const std::array<double, 2> printed_cot{3.2, 2.5}, printed_j{1428.75, 1312.23}, printed_m{1.4, 1.2},
      real_cot{2.09, 2.24};
  const std::array<const char*, 2> cot_text{"3.2", "2.5"}, j_text{"1428.75 J", "1312.23 J"},
      m_text{"1.4 m", "1.2 m"}, real_text{"2.09", "2.24"};
  for (std::size_t k = 0; k < r.walks.size(); ++k) {
    const StudiedWalk& w = r.walks[k];
    const std::string mode = name_of(w.mode);
    const walk::Rollout& ten = w.energy.ten_s;
    const double none = w.found ? 0.0 : kNothing;
    if (w.search) {
      const auto first = w.search->first_walk;
      r.times.push_back(compare({"III, Fig. 6", mode + ": processor time until the first walk of 10 s", "s",
                                 "0.05 days on 7 threads", first ? first->cpu_s : kNothing},
                                {0.0, 0.05 * kDay_s * kTheirThreads}));
      r.times.push_back(compare({"III, Fig. 6", mode + ": processor time of the search", "s",
                                 "0.8 days on 7 threads", w.search->cpu_s},
                                {0.0, 0.8 * kDay_s * kTheirThreads}));
      r.times.push_back(compare(
          {"III", mode + ": steps of simulation a second and processor, controller and limits included",
           "kHz", "70 kHz", 1e-3 * static_cast<double>(w.search->steps) / w.search->cpu_s},
          {70.0, 1e6}));
    }
    rows.push_back(compare({"III, Fig. 6", mode + ": cost of transport over 10 s, start and stop included",
                            "", cot_text[k], none + ten.cot},
                           {0.0, 1.02 * printed_cot[k]}));
    rows.push_back({"III", mode + ": way in 10 s", "m", "", none + ten.distance_m});
    Row hundred{
        "III", mode + ": cost of transport over 100 s", "", k == 1 ? "1.41" : "",
        none + (w.energy.hundred_s.ending == walk::Ending::stands ? w.energy.hundred_s.cot : kNothing)};
    rows.push_back(k == 1 ? compare(hundred, {0.0, 1.05 * 1.41}) : hundred);
    for (const bool charged : {false, true}) {
      const walk::EnergyCase& c = case_of(w, charged ? walk::kGear500Charged : walk::kGear500);
      const walk::EnergyBalance& e = c.sought ? *c.sought : c.same;
      const bool walks = c.sought.has_value();
      const double over_100_s =
          walks && e.hundred_s.ending == walk::Ending::stands ? e.hundred_s.cot : kNothing;
      Row row{"III", mode + ": " + c.what + ", cost of transport over 100 s", "",
              k == 1 && !charged ? "0.9" : "", over_100_s};
      row.remark =
          "Over 10 s " + (walks ? number(e.ten_s.cot, 3) : std::string("none within all limits")) + ".";
      rows.push_back(k == 1 && !charged ? compare(row, {0.0, 1.05 * 0.9}) : row);
    }
    if (w.map.found)
      rows.push_back(
          {"III",
           mode + ": largest multiplier of the return map",
           "",
           "",
           w.map.multipliers.front(),
           {},
           Outcome::computed,
           "Over a stride of " + number(w.map.stride_s, 3) + " s and " + number(w.map.stride_m, 3) + " m."});
    const std::string real = "The print's are measured on the real robot, with a walk of another search.";
    rows.push_back({"IV, Fig. 10",
                    mode + ": energy in 6 s",
                    "J",
                    j_text[k],
                    none + w.six_s.energy_j(),
                    {},
                    Outcome::computed,
                    real});
    rows.push_back({"IV, Fig. 10",
                    mode + ": way in 6 s",
                    "m",
                    m_text[k],
                    none + w.six_s.distance_m,
                    {},
                    Outcome::computed,
                    real});
    rows.push_back({"IV",
                    mode + ": cost of transport over 6 s",
                    "",
                    real_text[k],
                    none + w.six_s.cot,
                    {},
                    Outcome::computed,
                    real});
    rows.push_back(put_in({"IV", mode + ": cost of transport from the printed energy and way", "",
                           real_text[k], printed_j[k] / (49.8 * 9.8 * printed_m[k])},
                          {real_cot[k] - 0.005, real_cot[k] + 0.005}, "Arithmetic on printed figures."));
  }
  if (r.walks.size() == 2 && r.walks[0].found && r.walks[1].found) {
    const walk::Rollout &active = r.walks[0].six_s, &passive = r.walks[1].six_s;
    rows.push_back(compare({"IV", "energy in 6 s, semi-passive against active", "", "0.918: less",
                            passive.energy_j() / active.energy_j()},
                           {0.0, 0.999}));
    rows.push_back(compare({"IV", "cost of transport over 6 s, semi-passive against active", "", "1.07: more",
                            passive.cot / active.cot},
                           {1.001, 100.0}));
  }
  rows.push_back(put_in({"IV", "joints with a motor in semi-passive walking", "", "10 (less than 12)", 10.0},
                        {10.0, 10.0}, "The mode."));
  rows.push_back({"II", "pin of the hip goes in while the motor follows the link", "s", "", r.pin.time_s});
  rows.push_back({"II", "meanwhile, motor off the link at most", "rad", "to zero", r.pin.apart_rad});
  rows.push_back(
      {"II", "swing from 0.5 rad comes back to, clutch open", "", "gear friction cut off", r.pin.back_open});
  rows.push_back({"II", "the same, motor joined", "", "", r.pin.back_joined});
}

}  // namespace

WalkReproduction reproduce_000(const WalkStudyOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  WalkReproduction out;
  out.options = options;
  out.model = walk::read_model(options.model);
  for (const walk::Walk& w : options.walks)
    if (w.robot != out.model.name)
      throw core::DataError("a walk of " + core::quoted(w.robot) + "; expected one of " +
                            core::quoted(out.model.name));
  constexpr std::array kModes{WalkMode::active, WalkMode::semi_passive};
  for (std::size_t k = 0; k < kModes.size(); ++k) {
    StudiedWalk w{kModes[k], false, {}, {}, {}, {}, {}, {}};
    // Half of the bar is that of the loops, if there are any.
    const double part = options.loops.empty() ? 0.5 : 0.25, from = part * static_cast<double>(k);
    const auto tell = [&](double share, const std::string& doing) {
      if (options.progress) options.progress(from + part * share, name_of(w.mode) + ": " + doing);
    };
    const walk::RolloutOptions rollout = rollout_of(out.model, w.mode);
    const auto given = std::find_if(options.walks.begin(), options.walks.end(),
                                    [&](const walk::Walk& g) { return g.mode == w.mode; });
    if (given != options.walks.end()) {
      w.walk = given->parameters;
      const walk::Rollout r = walk::run_walk(out.model.robot, rollout, w.walk);
      w.found = r.keeps_limits() && r.distance_m > 0.0;
    } else {
      walk::SearchOptions search;
      search.rollout = rollout;
      search.seed = options.seed;
      search.steps = options.steps;
      search.threads = options.threads;
      search.progress = [&](double share, const std::string& doing) { tell(0.6 * share, doing); };
      walk::SearchResult found = walk::search_walk(out.model.robot, search);
      w.walk = found.walk;
      w.found = found.found;
      w.search = std::move(found.state);
    }
    w.energy = walk::energy_of(out.model.robot, rollout, w.walk);
    walk::RolloutOptions six = rollout;
    six.time_s = 6.0;
    w.six_s = walk::run_walk(out.model.robot, six, w.walk);
    tell(0.6, "return map");
    w.map = walk::return_map_of(out.model.robot, rollout, w.walk);
    walk::EnergyStudyOptions study;
    study.steps = options.case_steps;
    study.seed = options.seed;
    study.threads = options.threads;
    study.progress = [&](double share, const std::string& doing) { tell(0.6 + 0.4 * share, doing); };
    w.cases = walk::study_energy(out.model, {out.model.name, w.mode, rollout.walk_until_s, w.walk}, study);
    out.walks.push_back(std::move(w));
  }
  out.pin = pin_of_hip();
  out.omissions = omissions_of_000(!options.loops.empty());
  add_rows(out);
  if (!options.loops.empty()) {
    LoopStudyOptions study{options.model, options.loops, options.threads, {}};
    study.progress = [&](double share, std::string_view doing) {
      if (options.progress) options.progress(0.5 + 0.5 * share, doing);
    };
    out.loops = study_loops(study);
    for (Row& row : rows_of(out.loops)) out.rows.push_back(std::move(row));
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

std::string to_json_text(const WalkReproduction& r) {
  using Json = nlohmann::ordered_json;
  const auto finite = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  Json out{{"schema", "furcula-reproduction/1"},
           {"document", "000"},
           {"seed", r.options.seed},
           {"steps", r.options.steps},
           {"case_steps", r.options.case_steps}};
  for (const Outcome o : {Outcome::met, Outcome::smaller, Outcome::explained, Outcome::differs,
                          Outcome::by_construction, Outcome::computed})
    out["count"][name(o)] = count(r.rows, o);
  for (const Row& row : r.rows) out["rows"].push_back(json_of(row));
  const auto balance = [&](const walk::EnergyBalance& e) {
    const auto one = [&](const walk::Rollout& t) {
      return Json{{"ending", walk::kEndingNames[static_cast<std::size_t>(t.ending)]},
                  {"keeps_limits", t.keeps_limits()},
                  {"distance_m", t.distance_m},
                  {"cot", finite(t.cot)},
                  {"total_j", t.energy_j()},
                  {"copper_j", t.copper_j},
                  {"work_j", t.work_j},
                  {"positive_work_j", t.positive_work_j},
                  {"constant_j", t.constant_j}};
    };
    Json joints = Json::array();
    for (const walk::JointEnergy& j : e.joints)
      joints.push_back(
          {{"work_j", j.work_j}, {"positive_work_j", j.positive_work_j}, {"copper_j", j.copper_j}});
    return Json{{"10_s", one(e.ten_s)}, {"100_s", one(e.hundred_s)}, {"joints", joints}};
  };
  for (const StudiedWalk& w : r.walks) {
    Json cases = Json::array();
    for (const walk::EnergyCase& c : w.cases)
      cases.push_back({{"what", c.what},
                       {"mode", walk::kModeNames[static_cast<std::size_t>(c.mode)]},
                       {"same", balance(c.same)},
                       {"sought", c.sought ? balance(*c.sought) : Json(nullptr)}});
    Json history = Json::array();
    if (w.search)
      for (const walk::SearchPoint& p : w.search->history)
        history.push_back({p.steps, p.objective, finite(p.cot)});
    out["walks"].push_back({{"mode", walk::kModeNames[static_cast<std::size_t>(w.mode)]},
                            {"found", w.found},
                            {"energy", balance(w.energy)},
                            {"multipliers", w.map.multipliers},
                            {"history", history},
                            {"cases", cases}});
  }
  return out.dump(2) + "\n";
}

namespace {

std::string cases_html(const StudiedWalk& w) {
  report::Table t({{"One thing otherwise"},
                   {"the same walk"},
                   {"J", true},
                   {"m", true},
                   {"CoT", true},
                   {"CoT, 100 s", true},
                   {"sought again: J", true},
                   {"m", true},
                   {"CoT", true},
                   {"CoT, 100 s", true}});
  const auto figures = [](const walk::EnergyBalance& e) {
    const bool stands = e.hundred_s.ending == walk::Ending::stands;
    return std::array<std::string, 4>{number(e.ten_s.energy_j(), 4), number(e.ten_s.distance_m, 3),
                                      number(e.ten_s.cot, 3),
                                      stands ? number(e.hundred_s.cot, 3) : std::string("falls")};
  };
  for (const walk::EnergyCase& c : w.cases) {
    const walk::Rollout& r = c.same.ten_s;
    const auto same = figures(c.same);
    std::vector<std::string> cells{report::escape(c.what),
                                   r.keeps_limits()                   ? "keeps all limits"
                                   : r.ending == walk::Ending::stands ? "beyond a limit"
                                                                      : "falls",
                                   same[0],
                                   same[1],
                                   same[2],
                                   same[3]};
    if (c.sought)
      for (const std::string& s : figures(*c.sought)) cells.push_back(s);
    else
      cells.push_back("none");
    t.add(std::move(cells));
  }
  return t.html();
}

}  // namespace

std::string render_walk_reproduction_report(const WalkReproduction& r, const std::string& command) {
  std::vector<report::Line> objective, cot;
  for (const StudiedWalk& w : r.walks) {
    if (!w.search) continue;
    report::Line o{name_of(w.mode), {}, {}}, c{name_of(w.mode), {}, {}};
    for (const walk::SearchPoint& p : w.search->history) {
      o.x.push_back(p.cpu_s), o.y.push_back(p.objective);
      if (std::isfinite(p.cot) && p.cot < 20.0 && p.objective < 1.0)
        c.x.push_back(p.cpu_s), c.y.push_back(p.cot);
    }
    objective.push_back(std::move(o)), cot.push_back(std::move(c));
  }
  report::Page page;
  page.title = "Document 000, reproduced";
  page.command = command;
  const std::size_t printed =
      count(r.rows, Outcome::met) + count(r.rows, Outcome::explained) + count(r.rows, Outcome::differs);
  std::string energies, cases;
  for (const StudiedWalk& w : r.walks) {
    energies += "<h3>" + report::escape(name_of(w.mode)) + ", 10 s</h3>\n" +
                walk::motors_html(w.energy.joints, w.energy.ten_s);
    cases += "<h3>" + report::escape(name_of(w.mode)) + "</h3>\n" + cases_html(w);
  }
  report::Table omitted({{"Where"}, {"Printed"}, {""}, {"Why it is not computed"}});
  for (const Omission& o : r.omissions)
    omitted.add({report::escape(o.where), report::escape(o.published),
                 report::badge(name(o.because), report::Tone::neutral), report::escape(o.why)});
  page.body_html =
      "<header>\n<p class=\"eyebrow\">Semi-passive walk and active walk by one bipedal robot</p>\n<h1>Of " +
      std::to_string(printed) + " printed figures " + std::to_string(count(r.rows, Outcome::met)) +
      " are met, " + std::to_string(count(r.rows, Outcome::differs)) + " differ.</h1>\n</header>\n" +
      report::section("table", "Printed and computed", rows_html(r.rows)) +
      report::section("times", "Times, on this machine", rows_html(r.times)) +
      report::section(
          "search", "Fig. 6: the search",
          report::line_plot_html({"The best objective so far", "time of one processor, s", objective}) +
              report::line_plot_html(
                  {"Its cost of transport, where it walks", "time of one processor, s", cot})) +
      report::section(
          "walks", "The walks",
          "<p><a href=\"active.html\">Active</a> and <a href=\"semi_passive.html\">semi-passive</a>: the robot "
          "walking, its margins and curves.</p>\n") +
      report::section("joints", "Energy by joint", energies) +
      report::section("loops", "Figs. 7 and 8: loops of identification and search", loops_html(r.loops)) +
      report::section(
          "cases", "What would change it",
          report::paragraph(
              "Each robot differs from the first in one thing. Its walk is the same, then the best "
              "that a search from it found, within all limits. All searches have one budget.") +
              cases) +
      report::section("omissions", "Not computed", omitted.html());
  return report::render(page);
}

}  // namespace furcula::reproduce
