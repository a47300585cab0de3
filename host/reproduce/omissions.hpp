// What document 002 prints and no row computes anew: its numbers, figures and tables, each with the reason.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace furcula::reproduce {

/// Why something is not computed. Put in: an input here as there. Otherwise: done in another way here. Recording:
/// of the document's machine. Equipment: a part's name plate. Drawing: or a photograph. Other work: reported
/// from the literature. Not computed: could be, and is not.
enum class Because : std::uint8_t {
  put_in,
  otherwise,
  recording,
  equipment,
  drawing,
  other_work,
  not_computed
};

const char* name(Because because);

struct Omission {
  std::string where;      ///< "4.2.1.1"
  std::string published;  ///< as printed, with its units
  Because because;
  std::string why;
};

/// In the document's order.
std::vector<Omission> omissions_of_002();

}  // namespace furcula::reproduce
