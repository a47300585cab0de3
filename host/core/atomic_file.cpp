// Writing whole files, see atomic_file.hpp.
#include "host/core/atomic_file.hpp"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

namespace furcula::core {
namespace {

[[noreturn]] void give_up(const std::string& path, int error) {
  throw OutputError(path + ": cannot be written: " + std::strerror(error));
}

// Writes everything and closes; on failure the errno, else 0.
int write_and_close(int fd, std::string_view content, bool to_disk) {
  int error = 0;
  while (!content.empty() && error == 0) {
    const ssize_t n = ::write(fd, content.data(), content.size());
    if (n >= 0) {
      content.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  // Without the sync a power cut after the rename could leave an empty file under the final name.
  if (error == 0 && to_disk && ::fsync(fd) != 0) error = errno;
  if (::close(fd) != 0 && error == 0) error = errno;
  return error;
}

/// A file's new content beside its place, on the disk.
struct Staged {
  std::string path;    ///< as it was asked for
  std::string target;  ///< what a link names
  std::string temporary;
  bool exists = false;
};

bool is_device(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

/// A pipe that no program reads from is not waited for.
void write_to_device(const std::string& path, std::string_view content) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0 && errno == ENXIO)
    throw OutputError(path + ": cannot be written: no program reads from this pipe");
  if (fd < 0) give_up(path, errno);
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) & ~O_NONBLOCK);
  if (const int error = write_and_close(fd, content, false)) give_up(path, error);
}

Staged stage(const std::string& path, std::string_view content) {
  struct stat status {};
  Staged staged{path, path, {}, ::stat(path.c_str(), &status) == 0};
  if (staged.exists && S_ISDIR(status.st_mode)) give_up(path, EISDIR);
  // A link's target is replaced, not the link.
  std::error_code ignored;
  if (staged.exists) staged.target = std::filesystem::canonical(path, ignored).string();
  if (staged.target.empty()) give_up(path, ENOENT);
  staged.temporary = staged.target + ".part-XXXXXX";
  const int fd = ::mkostemp(staged.temporary.data(), O_CLOEXEC);
  if (fd < 0) give_up(path, errno);
  // mkostemp gives 0600; the result shall have the old file's mode, or that of any new file.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  int error = ::fchmod(fd, staged.exists ? status.st_mode & 07777 : 0666 & ~mask) == 0 ? 0 : errno;
  const int write_error = write_and_close(fd, content, true);
  if (error == 0) error = write_error;
  if (error != 0) {
    ::unlink(staged.temporary.c_str());
    give_up(path, error);
  }
  return staged;
}

/// Signals wait as long as it lives.
class SignalsWait {
 public:
  SignalsWait() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsWait() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;

 private:
  sigset_t before_{};
};

/// What was done to a name, so that it can be undone: what it had is under another name, if it had anything.
struct Done {
  std::string name, old;
};

/// A name beside `path` that nothing has.
std::string free_name(const std::string& path) {
  std::string name = path + ".old-XXXXXX";
  const int fd = ::mkostemp(name.data(), O_CLOEXEC);
  if (fd < 0) return {};
  ::close(fd);
  return name;
}

/// Moves what stands under a name aside. The errno, or 0.
int put_aside(const std::string& name, std::vector<Done>& done) {
  const std::string old = free_name(name);
  if (old.empty()) return errno;
  if (::rename(name.c_str(), old.c_str()) != 0) {
    const int error = errno;
    ::unlink(old.c_str());
    return error;
  }
  done.push_back({name, old});
  return 0;
}

/// Gives the new file its name. The errno, or 0.
int put_in_place(const Staged& s, std::vector<Done>& done) {
  if (!s.exists) {
    if (::rename(s.temporary.c_str(), s.target.c_str()) != 0) return errno;
    done.push_back({s.target, {}});
    return 0;
  }
  // In one step, where the file system can: there is no instant without the file.
  if (::renameat2(AT_FDCWD, s.temporary.c_str(), AT_FDCWD, s.target.c_str(), RENAME_EXCHANGE) == 0) {
    done.push_back({s.target, s.temporary});
    return 0;
  }
  if (errno != EINVAL && errno != ENOSYS) return errno;
  if (const int error = put_aside(s.target, done)) return error;
  return ::rename(s.temporary.c_str(), s.target.c_str()) == 0 ? 0 : errno;
}

/// So that a power cut does not undo the names.
void sync_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const int fd = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

}  // namespace

void write_file_atomically(const std::string& path, std::string_view content) {
  if (is_device(path)) {
    write_to_device(path, content);
    return;
  }
  const Staged staged = stage(path, content);
  if (::rename(staged.temporary.c_str(), staged.target.c_str()) != 0) {
    const int error = errno;
    ::unlink(staged.temporary.c_str());
    give_up(path, error);
  }
}

void write_files_together(std::span<const NewFile> files, std::span<const std::string> obsolete) {
  std::vector<Staged> staged;
  std::vector<Done> done;
  staged.reserve(files.size());
  done.reserve(files.size() + obsolete.size());
  const auto remove_temporaries = [&staged] {
    for (const Staged& s : staged) ::unlink(s.temporary.c_str());
  };
  try {
    for (const NewFile& file : files)
      if (is_device(file.path))
        write_to_device(file.path, file.content);
      else
        staged.push_back(stage(file.path, file.content));
  } catch (...) {
    remove_temporaries();
    throw;
  }

  const SignalsWait signals_wait;
  int error = 0;
  std::string failed;
  for (const Staged& s : staged)
    if (error == 0 && (error = put_in_place(s, done)) != 0) failed = s.path;
  for (const std::string& path : obsolete) {
    struct stat status {};
    if (error == 0 && ::lstat(path.c_str(), &status) == 0 && (error = put_aside(path, done)) != 0)
      failed = path;
  }
  for (auto d = done.rbegin(); error != 0 && d != done.rend(); ++d) {
    if (d->old.empty())
      ::unlink(d->name.c_str());
    else
      ::rename(d->old.c_str(), d->name.c_str());
  }
  if (error != 0) {
    remove_temporaries();
    give_up(failed, error);
  }
  for (const Done& d : done)
    if (!d.old.empty()) ::unlink(d.old.c_str());
  if (!staged.empty()) sync_folder_of(staged.front().target);
}

}  // namespace furcula::core
