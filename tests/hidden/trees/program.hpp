// Runs the program under test on a case's folder.
#pragma once

#include <string>
#include <vector>

namespace furcula::hidden::trees {

/// `program diagnose` on the model and logs in `folder`; the last `held_out` logs are held out. Writes to
/// FOLDER/diagnosis/, what the program prints to FOLDER/diagnosis.txt. Returns why there is no diagnosis; empty: there is
/// one.
std::string diagnosed(const std::string& program, const std::string& folder,
                      const std::vector<std::string>& logs, std::size_t held_out, double timeout_s);

}  // namespace furcula::hidden::trees
