#include "host/gait/workers.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace furcula::gait {
namespace {

/// A frame is kind, job, length, bytes.
enum class Kind : std::uint32_t { told, done, failed };
struct Head {
  Kind kind;
  std::uint32_t job, length;
};

void write_all(int to, const void* from, std::size_t size) {
  const char* at = static_cast<const char*>(from);
  while (size > 0) {
    const ssize_t n = ::write(to, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) ::_exit(1);  // nobody listens any more
    at += n;
    size -= static_cast<std::size_t>(n);
  }
}

void send(int to, Kind kind, std::size_t job, std::string_view text) {
  const Head head{kind, static_cast<std::uint32_t>(job), static_cast<std::uint32_t>(text.size())};
  write_all(to, &head, sizeof head);
  write_all(to, text.data(), text.size());
}

struct Worker {
  pid_t pid = -1;
  int from = -1;
  std::string bytes;
};

/// Ends what still runs, and waits for all.
struct Workers {
  std::vector<Worker> all;
  Workers() = default;
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  ~Workers() {
    for (Worker& w : all) {
      if (w.from >= 0) {
        ::kill(w.pid, SIGKILL);
        ::close(w.from);
      }
      ::waitpid(w.pid, nullptr, 0);
    }
  }
};

}  // namespace

std::vector<std::string> in_processes(std::size_t count, unsigned processes,
                                      const std::function<std::string(std::size_t, const Tell&)>& job,
                                      const std::function<void(std::size_t, std::string_view)>& told) {
  std::vector<std::string> out(count);
  const std::size_t used = std::min<std::size_t>(std::max(1u, processes), count);
  if (used <= 1) {
    for (std::size_t i = 0; i < count; ++i)
      out[i] = job(i, [&](std::string_view line) {
        if (told) told(i, line);
      });
    return out;
  }
  Workers workers;
  workers.all.reserve(used);
  for (std::size_t w = 0; w < used; ++w) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    const pid_t pid = ::fork();
    if (pid < 0) {
      ::close(ends[0]);
      ::close(ends[1]);
      throw std::system_error(errno, std::generic_category(), "fork");
    }
    if (pid == 0) {
      ::close(ends[0]);
      for (std::size_t i = w; i < count; i += used) try {
          send(ends[1], Kind::done, i,
               job(i, [&](std::string_view line) { send(ends[1], Kind::told, i, line); }));
        } catch (const std::exception& e) {
          send(ends[1], Kind::failed, i, e.what());
        } catch (...) {
          send(ends[1], Kind::failed, i, "unexpected error");
        }
      ::_exit(0);
    }
    ::close(ends[1]);
    workers.all.push_back({pid, ends[0], {}});
  }

  std::vector<bool> done(count, false);
  for (;;) {
    std::vector<pollfd> open;
    std::vector<std::size_t> whose;
    for (std::size_t w = 0; w < used; ++w)
      if (workers.all[w].from >= 0) {
        open.push_back({workers.all[w].from, POLLIN, 0});
        whose.push_back(w);
      }
    if (open.empty()) break;
    if (::poll(open.data(), open.size(), -1) < 0 && errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "poll");
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (open[k].revents == 0) continue;
      Worker& worker = workers.all[whose[k]];
      char buffer[65536];
      const ssize_t n = ::read(worker.from, buffer, sizeof buffer);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        ::close(worker.from);
        worker.from = -1;
        continue;
      }
      worker.bytes.append(buffer, static_cast<std::size_t>(n));
      for (;;) {
        Head head;
        if (worker.bytes.size() < sizeof head) break;
        std::memcpy(&head, worker.bytes.data(), sizeof head);
        if (worker.bytes.size() < sizeof head + head.length) break;
        const std::string text = worker.bytes.substr(sizeof head, head.length);
        worker.bytes.erase(0, sizeof head + head.length);
        if (head.kind == Kind::failed) throw std::runtime_error(text);
        if (head.kind == Kind::told) {
          if (told) told(head.job, text);
          continue;
        }
        out[head.job] = text;
        done[head.job] = true;
      }
    }
  }
  if (std::find(done.begin(), done.end(), false) != done.end())
    throw std::runtime_error("a process ended before it had a result");
  return out;
}

}  // namespace furcula::gait
