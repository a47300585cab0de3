// How fast logs are checked, read and written: bytes a second over 100,000 rows of the hopper's log.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <random>
#include <string>

#include "host/log/reader.hpp"
#include "host/log/writer.hpp"

namespace {

using namespace furcula;

// Full-length numbers (`digits` = 17), or those that a rig writes (4).
std::string rows(int digits) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> height(0.2, 0.4), torque(-5.0, 5.0);
  std::string text =
      "time_s,height_m,velocity_mps,leg_angle_rad,contact,torque_cmd_nm,torque_nm,solenoid,clutch_travel_m\n";
  char row[300];
  for (int i = 0; i < 100000; ++i) {
    const double h = height(random), t = torque(random);
    std::snprintf(row, sizeof row, "%.3f,%.*g,%.*g,%.*g,%d,%.*g,%.*g,0,0.0\n", 0.001 * i, digits, h, digits,
                  t, digits, h, i % 2, digits, t, digits, -t);
    text += row;
  }
  return text;
}

std::string written_file(int digits) {
  const std::string path = std::string("/tmp/furcula_log_bench_") + std::to_string(digits) + ".csv";
  std::FILE* file = std::fopen(path.c_str(), "wb");
  const std::string text = rows(digits);
  std::fwrite(text.data(), 1, text.size(), file);
  std::fclose(file);
  return path;
}

void label(benchmark::State& state, const char* what) {
  state.SetLabel(std::string(what) + " 100,000 rows, numbers of " + std::to_string(state.range(0)) +
                 " digits");
}

void check_log(benchmark::State& state) {
  label(state, "check");
  const int digits = static_cast<int>(state.range(0));
  const std::string path = written_file(digits);
  for (auto _ : state) benchmark::DoNotOptimize(log::check_log(path, "hopper").rows);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(rows(digits).size()));
  std::remove(path.c_str());
}
BENCHMARK(check_log)->Arg(4)->Arg(17)->Unit(benchmark::kMillisecond);

void parse_log(benchmark::State& state) {
  label(state, "read");
  const std::string text = rows(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(log::parse_log(text, "bench", "hopper").rows());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(parse_log)->Arg(4)->Arg(17)->Unit(benchmark::kMillisecond);

void format_log(benchmark::State& state) {
  label(state, "write");
  const std::string text = rows(static_cast<int>(state.range(0)));
  const log::Log log = log::parse_log(text, "bench", "hopper");
  for (auto _ : state) benchmark::DoNotOptimize(log::format_log(log).size());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(format_log)->Arg(4)->Arg(17)->Unit(benchmark::kMillisecond);

}  // namespace
