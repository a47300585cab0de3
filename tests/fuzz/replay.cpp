// Replays a target's corpus: `replay FOLDER`. Files named good_* must be taken, bad_* refused; all others
// (what a fuzzer has found once) must end in one of both.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/fuzz/target.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("expected one folder\n", stderr);
    return 2;
  }
  int files = 0, wrong = 0;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    const std::string name = entry.path().filename();
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string input{std::istreambuf_iterator<char>(in), {}};
    std::fprintf(stderr, "%s\n", name.c_str());  // the last line shows which file ended the program
    const bool accepted = furcula::fuzz::accepts(input);
    if ((name.starts_with("good_") && !accepted) || (name.starts_with("bad_") && accepted)) {
      std::fprintf(stderr, "  was %s\n", accepted ? "taken" : "refused");
      ++wrong;
    }
    ++files;
  }
  std::printf("%d files, %d wrong\n", files, wrong);
  return files > 0 && wrong == 0 ? 0 : 1;
}
