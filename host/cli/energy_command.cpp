// `furcula energy`: what a hop costs with the clutch, without, and without a spring.
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/cli/within.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/message.hpp"
#include "host/energy/study.hpp"
#include "host/energy/study_json.hpp"
#include "host/energy/study_report.hpp"
#include "host/model/reader.hpp"

namespace furcula::cli {
namespace {

struct EnergyOptions {
  std::string model, out;
  energy::Options study;
};

std::string centimetres(const std::optional<double>& length_m) {
  char text[32] = "nowhere";
  if (length_m) std::snprintf(text, sizeof text, "%.1f cm", 100.0 * *length_m);
  return text;
}

void run(const EnergyOptions& o) {
  const model::Model model = model::read_model(o.model);
  const OutFolder folder(o.out);
  energy::Options options = o.study;
  if (options.threads == 0) options.threads = std::max(1u, std::thread::hardware_concurrency());
  energy::Study s;
  {
    Progress progress("energy");
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    s = energy::run_study(model, options);
  }
  const std::string command =
      "furcula energy --model " + o.model + " --apex-m " + core::shortest(o.study.apex_m) +
      " --clutch-mass-kg " + core::shortest(o.study.clutch_mass_kg) + " --contraction-max-m " +
      core::shortest(o.study.most_contraction_m) + " --points " + std::to_string(o.study.points) +
      " --torque-constant-nmpa " + core::shortest(o.study.motor.torque_constant_nmpa) + " --resistance-ohm " +
      core::shortest(o.study.motor.resistance_ohm) + " --out " + o.out;
  core::write_files_together(
      std::vector<core::NewFile>{{o.out + "/energy.json", energy::to_json_text(s)},
                                 {o.out + "/report.html", energy::render_energy_report(s, command)}});

  std::printf("J a hop (peak N m in flight and in stance) at an apex of %g m\n", o.study.apex_m);
  std::printf("%-11s%32s%32s%32s\ncontraction", "", "caught", "with the clutch", "without a spring");
  for (int i = 0; i < 3; ++i) std::printf("%9s%9s%7s%7s", "mech.", "electr.", "flight", "stance");
  std::printf("\n");
  const auto robot = [](const std::optional<energy::Settled>& r) {
    if (!r) {
      std::printf("%9s%9s%7s%7s", "-", "-", "-", "-");
      return;
    }
    const energy::HopEnergy& e = r->energy;
    std::printf("%9.2f%9.2f%7.1f%7.1f", energy::cost_j(e, energy::Measure::mechanical),
                energy::cost_j(e, energy::Measure::electrical), e.peak_torque_flight_nm,
                e.peak_torque_stance_nm);
  };
  for (const energy::Point& p : s.points) {
    std::printf("%8.1f cm", 100.0 * p.contraction_m);
    robot(p.caught);
    robot(p.clutched);
    robot(p.springless);
    std::printf("\n");
  }
  std::printf(
      "break-even: mechanical %s, electrical %s; as published (k A^2/2 against %.2f J of coil) %s, with %.2f J for "
      "the clutch's mass %s\n",
      centimetres(s.mechanical_m).c_str(), centimetres(s.electrical_m).c_str(), s.published.coil_j,
      centimetres(s.published.break_even_m).c_str(), s.published.mass_j,
      centimetres(s.published.break_even_with_mass_m).c_str());
  std::printf("without a spring it costs less than against a caught one from: mechanical %s, electrical %s\n",
              centimetres(s.springless_mechanical_m).c_str(), centimetres(s.springless_electrical_m).c_str());
  for (const energy::Variant& v : s.variants)
    std::printf("  %-42s mechanical %s, electrical %s\n", v.what.c_str(), centimetres(v.mechanical_m).c_str(),
                centimetres(v.electrical_m).c_str());
  std::printf("report: %s/report.html\n", core::printable(o.out).c_str());
}

}  // namespace

void add_energy_command(CLI::App& app) {
  auto options = std::make_shared<EnergyOptions>();
  options->study.threads = 0;
  CLI::App* command = app.add_subcommand(
      "energy", "What a hop costs with the spring caught, with the clutch, and without a spring");
  command
      ->add_option("--model", options->model,
                   "hopper_nonlinear with a clutch, without the clutch's mass (TOML)")
      ->required();
  command->add_option("--apex-m", options->study.apex_m, "That all reach")
      ->check(within(0.05, 5.0))
      ->capture_default_str();
  command->add_option("--clutch-mass-kg", options->study.clutch_mass_kg, "Mass of the clutch")
      ->check(within(0.0, 100.0))
      ->capture_default_str();
  command
      ->add_option("--contraction-max-m", options->study.most_contraction_m, "Largest contraction in flight")
      ->check(within(0.001, 1.0))
      ->capture_default_str();
  command->add_option("--points", options->study.points, "Contractions, from none to the largest")
      ->check(CLI::Range(std::size_t{2}, std::size_t{1000}))
      ->capture_default_str();
  command
      ->add_option("--torque-constant-nmpa", options->study.motor.torque_constant_nmpa, "Of the leg's motor")
      ->check(within(1e-4, 1e3))
      ->capture_default_str();
  command->add_option("--resistance-ohm", options->study.motor.resistance_ohm, "Of the leg's motor")
      ->check(within(0.0, 1e3))
      ->capture_default_str();
  command->add_option("--threads", options->study.threads, "Threads; without it as many as processors");
  command->add_option("--out", options->out, "Folder for report.html and energy.json")->required();
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
