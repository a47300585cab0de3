// The words of verdicts, see verdict_words.hpp.
#include "host/report/verdict_words.hpp"

namespace furcula::report {

VerdictWords words(Verdict v) {
  switch (v) {
    case Verdict::adequate:
      return {"Adequate", Tone::good, "The model describes these recordings as well as their noise allows."};
    case Verdict::explained:
      return {"Explained", Tone::good,
              "What the model got wrong has a cause with a name, and with it little remains."};
    case Verdict::partly_explained:
      return {"Partly explained", Tone::notice,
              "A named cause explains a part of the error; what remains still has structure."};
    case Verdict::unexplained:
      return {
          "Unexplained", Tone::bad,
          "The error has structure, and no effect of the catalogue removes it. See what it is correlated with."};
    case Verdict::not_identifiable:
      return {"Not identifiable", Tone::notice,
              "Two or more causes would remove the error equally well, or the data are too poor. Another "
              "experiment tells them apart."};
  }
  return {"", Tone::neutral, ""};
}

}  // namespace furcula::report
