#include "host/walk/ranks.hpp"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <thread>
#include <type_traits>

#include "host/core/own_build.hpp"

namespace furcula::walk {
namespace {

enum Tag { kTask, kEnsemble, kJobs, kRollouts, kCpuTime, kEnd };
constexpr std::chrono::milliseconds kPatience{500};  // for ranks that may be dead
constexpr std::chrono::microseconds kPause{
    50};  // between two looks: waiting takes no processor from those who walk

/// What a search's jobs have in common.
struct Task {
  std::uint32_t build;
  unsigned threads;
  dynamics::biped::Description robot;
  RolloutOptions rollout;
};
static_assert(std::is_trivially_copyable_v<Task> && std::is_trivially_copyable_v<Rollout> &&
              std::is_trivially_copyable_v<Member> && std::is_trivially_copyable_v<Job>);

/// On the robot, or on the members of the ensemble: not both in one call.
std::vector<Rollout> run(const Task& task, const std::vector<Member>& ensemble, std::vector<Job> jobs) {
  if (jobs.empty() || jobs.front().member == 0)
    return run_jobs(task.robot, {}, task.rollout, jobs, task.threads);
  for (Job& job : jobs) --job.member;
  return run_jobs(task.robot, ensemble, task.rollout, jobs, task.threads);
}

template <class T>
int bytes_of(const std::vector<T>& all) {
  return static_cast<int>(all.size() * sizeof(T));
}

/// Those of a rank.
std::vector<std::size_t> share(std::size_t walks, int rank, int count) {
  std::vector<std::size_t> out;
  for (auto i = static_cast<std::size_t>(rank); i < walks; i += static_cast<std::size_t>(count))
    out.push_back(i);
  return out;
}

}  // namespace

Ranks::Ranks() {
  int given = MPI_THREAD_SINGLE;
  // Threads run walks; this one alone speaks to other ranks.
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
}

Ranks::~Ranks() {
  if (given_up_) return;
  if (rank_ == 0)
    for (int to = 1; to < count_; ++to) MPI_Send(nullptr, 0, MPI_BYTE, to, kEnd, MPI_COMM_WORLD);
  MPI_Finalize();
}

void Ranks::serve() const {
  Task task{};
  std::vector<Member> ensemble;
  for (;;) {
    MPI_Status status;
    for (int is = 0; is == 0;) {
      MPI_Iprobe(0, MPI_ANY_TAG, MPI_COMM_WORLD, &is, &status);
      if (is == 0) std::this_thread::sleep_for(kPause);
    }
    int bytes = 0;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    std::vector<Job> jobs;
    void* to = nullptr;
    switch (status.MPI_TAG) {
      case kTask:
        to = &task;
        break;
      case kEnsemble:
        ensemble.resize(static_cast<std::size_t>(bytes) / sizeof(Member));
        to = ensemble.data();
        break;
      default:
        jobs.resize(static_cast<std::size_t>(bytes) / sizeof(Job));
        to = jobs.data();
    }
    MPI_Recv(to, bytes, MPI_BYTE, 0, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (status.MPI_TAG == kEnd) return;
    if (status.MPI_TAG == kEnsemble) continue;
    if (status.MPI_TAG == kTask) {
      if (task.build == core::own_build_id()) continue;
      std::fprintf(
          stderr,
          "furcula-mpi: rank %d is of another build than rank 0; expected the same on every machine\n",
          rank_);
      MPI_Abort(MPI_COMM_WORLD, 2);
    }
    const std::clock_t begin = std::clock();
    const std::vector<Rollout> rollouts = run(task, ensemble, std::move(jobs));
    const double took_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    MPI_Send(rollouts.data(), bytes_of(rollouts), MPI_BYTE, 0, kRollouts, MPI_COMM_WORLD);
    MPI_Send(&took_s, 1, MPI_DOUBLE, 0, kCpuTime, MPI_COMM_WORLD);
  }
}

bool Ranks::finished(void* requests, int count, const std::function<bool()>& interrupted) const {
  using Clock = std::chrono::steady_clock;
  for (auto doubted = Clock::time_point::max();;) {
    int are = 0;
    MPI_Testall(count, static_cast<MPI_Request*>(requests), &are, MPI_STATUSES_IGNORE);
    if (are != 0) return true;
    const auto now = Clock::now();
    if (interrupted && interrupted()) doubted = std::min(doubted, now);
    if (doubted < now && now - doubted > kPatience) return false;
    std::this_thread::sleep_for(kPause);
  }
}

void Ranks::run_for(const dynamics::biped::Description& robot, SearchOptions& options) {
  const Task task{core::own_build_id(), options.threads, robot, options.rollout};
  for (int to = 1; to < count_; ++to) {
    MPI_Send(&task, sizeof task, MPI_BYTE, to, kTask, MPI_COMM_WORLD);
    MPI_Send(options.ensemble.data(), bytes_of(options.ensemble), MPI_BYTE, to, kEnsemble, MPI_COMM_WORLD);
  }
  options.cpu_elsewhere_s = [this] { return others_cpu_s_; };
  options.run = [this, task, ensemble = options.ensemble,
                 interrupted = options.interrupted](const std::vector<Job>& jobs) {
    const auto others = static_cast<std::size_t>(count_ - 1);
    sent_.assign(others, {});
    received_.assign(others, {});
    took_cpu_s_.assign(others, 0.0);
    std::vector<MPI_Request> requests;
    requests.reserve(3 * others);
    for (std::size_t k = 0; k < others; ++k) {
      const int to = static_cast<int>(k) + 1;
      for (const std::size_t i : share(jobs.size(), to, count_)) {
        sent_[k].push_back(jobs[i]);
        received_[k].emplace_back();
      }
      MPI_Isend(sent_[k].data(), bytes_of(sent_[k]), MPI_BYTE, to, kJobs, MPI_COMM_WORLD,
                &requests.emplace_back());
      MPI_Irecv(received_[k].data(), bytes_of(received_[k]), MPI_BYTE, to, kRollouts, MPI_COMM_WORLD,
                &requests.emplace_back());
    }
    for (std::size_t k = 0; k < others; ++k)
      MPI_Irecv(&took_cpu_s_[k], 1, MPI_DOUBLE, static_cast<int>(k) + 1, kCpuTime, MPI_COMM_WORLD,
                &requests.emplace_back());
    std::vector<Rollout> out(jobs.size());
    const auto put = [&](int rank, const std::vector<Rollout>& rollouts) {
      const auto numbers = share(jobs.size(), rank, count_);
      for (std::size_t k = 0; k < numbers.size(); ++k) out[numbers[k]] = rollouts[k];
    };
    std::vector<Job> own;
    for (const std::size_t i : share(jobs.size(), 0, count_)) own.push_back(jobs[i]);
    put(0, run(task, ensemble, std::move(own)));
    if (!finished(requests.data(), static_cast<int>(requests.size()), interrupted)) {
      given_up_ = true;
      return std::vector<Rollout>{};
    }
    for (std::size_t k = 0; k < others; ++k) {
      put(static_cast<int>(k) + 1, received_[k]);
      others_cpu_s_ += took_cpu_s_[k];
    }
    return out;
  };
}

}  // namespace furcula::walk
