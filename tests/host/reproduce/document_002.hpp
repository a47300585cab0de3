// What document 002 prints, gone through by hand: each number once with where it stands, each figure. A
// number is looked for in the rows and omissions whose place contains `where`, as they write it.
#pragma once

#include <string_view>
#include <vector>

namespace furcula::test {

struct Printed {
  std::string_view where, number;
};

/// Chapters 1 and 2.1 and the abstract print none, nor do 6.1.2 and 6.2 others than these. Not numbers in this
/// sense: those of equations, citations, the parts' names that have no unit.
inline const std::vector<Printed> kPrinted002{{"2", "66 %"},
                                              {"2", "80 %"},
                                              {"3.1", "20 to 60 deg"},
                                              {"Fig. 3.1", "5 links"},
                                              // 3.2.1, linear model
                                              {"3.2.1", "1 kHz"},
                                              {"3.2.1", "z(0) = 0.35 m"},
                                              {"3.2.1", "z'(0) = 0 m/s"},
                                              {"3.2.1", "L = 0.15 m"},
                                              {"3.2.1", "k = 600 N/m"},
                                              {"3.2.1", "m = 1.5 kg"},
                                              {"3.2.1", "ds = 5"},
                                              {"3.2.1", "df = 1 N s/m"},
                                              {"3.2.1", "both alphas 1"},
                                              {"3.2.1", "T = 2 N m"},
                                              {"3.2.1", "P = 0.3 s"},
                                              {"3.2.1", "alphas of 0.8"},
                                              {"3.2.1", "and 0.9"},
                                              // 3.2.2, non-linear model
                                              {"3.2.2", "50 g"},
                                              {"3.2.2", "500 g"},
                                              {"3.2.2", "300 g"},
                                              {"3.2.2", "9 10^-4"},
                                              {"3.2.2", "10^-4 and"},
                                              {"3.2.2", "0.15 m"},
                                              {"Table 3.1", "m = 1.6 kg"},
                                              {"Table 3.1", "k = 600 N/m"},
                                              {"Table 3.1", "ds = 5"},
                                              {"Table 3.1", "df = 1 N s/m"},
                                              {"Table 3.1", "42e-4"},
                                              {"Table 3.1", "75e-4"},
                                              {"Table 3.1", "e = 38 10^-3"},
                                              {"Table 3.1", "0.9 (given to the linear model)"},
                                              {"Table 3.1", "lift-off 1 of the linear model"},
                                              {"Table 3.1", "non-linear model's lift-off"},
                                              // 4, platform
                                              {"4", "80 kV"},
                                              {"4", "1200 W"},
                                              {"4", "2000 counts/rev"},
                                              {"4", "0.09 mm"},
                                              {"4", "1 kHz"},
                                              {"4.1", "Algorithm 1"},
                                              {"4.1", "10 ms"},
                                              {"Fig. 4.4", "5 ms"},
                                              // 4.2, estimation
                                              {"4.2", "15 Hz"},
                                              {"4.2", "third-order"},
                                              {"4.2", "1.62 kg"},
                                              {"4.2", "he6x6"},
                                              {"4.2", "605 N/m"},
                                              {"4.2", "2.7 N"},
                                              {"4.2", "0.2 kg"},
                                              {"4.2", "below 1 N"},
                                              {"4.2.1.1", "k = 605 N/m"},
                                              {"4.2.1.1", "9.81"},
                                              {"4.2.1.1", "0.289 m"},
                                              {"4.2.1.1", "60 experiments"},
                                              {"4.2.1.1", "10 folds"},
                                              {"4.2.1.1", "1.62 kg"},
                                              {"4.2.1.1", "20 experiments"},
                                              {"4.2.1.1", "5 folds"},
                                              {"4.2.1", "1.554"},
                                              {"4.2.1.1", "6.42"},
                                              {"4.2.1.1", "1.18"},
                                              {"4.2.1.2", "60 trajectories"},
                                              {"4.2.1.2", "10 folds"},
                                              // Captions
                                              {"Fig. 4.12", "0.6 %"},
                                              {"Fig. 4.12", "1.5 mm"},
                                              {"Fig. 4.12", "1.9 %"},
                                              {"Fig. 4.12", "53.6 mm/s"},
                                              {"Fig. 4.12", "6.8 %"},
                                              {"Fig. 4.12", "4.8 mm"},
                                              {"Fig. 4.12", "2.6 %"},
                                              {"Fig. 4.12", "54.6 mm/s"},
                                              {"Fig. 4.15", "4.9 %"},
                                              {"Fig. 4.15", "1.4 mm"},
                                              {"Fig. 4.15", "1.9 %"},
                                              {"Fig. 4.15", "53.6 mm/s"},
                                              {"Fig. 4.15", "6.8 %"},
                                              {"Fig. 4.15", "4.8 mm"},
                                              {"Fig. 4.15", "3.7 %"},
                                              {"Fig. 4.15", "20.8 mm/s"},
                                              {"Fig. 4.18", "0.75 %"},
                                              {"Fig. 4.18", "2.7 mm"},
                                              {"Fig. 4.18", "1.23 %"},
                                              {"Fig. 4.18", "49.6 mm/s"},
                                              {"Fig. 4.18", "2.1 %"},
                                              {"Fig. 4.18", "4.7 mm"},
                                              {"Fig. 4.18", "2.9 %"},
                                              {"Fig. 4.18", "89.1 mm/s"},
                                              // 5.1, the bench
                                              {"5.1", "M3"},
                                              {"5.1", "1.8 mm"},
                                              {"5.1", "20 N"},
                                              {"5.1", "2.5 mm"},
                                              {"5.1", "0 to 20 ms"},
                                              {"5.1", "3 cantilever beams"},
                                              {"5.1", "0.5 to 3 mm"},
                                              {"5.1", "2400 counts/rev"},
                                              {"5.1", "250 Hz"},
                                              {"5.1", "40 ms"},
                                              {"5.1", "1 kg"},
                                              {"5.1", "20 to 50 ms"},
                                              // 5.2, the modular clutch
                                              {"5.2", "stroke of 5 mm"},
                                              {"5.2", "15 kg"},
                                              {"5.2", "2 mm"},
                                              {"5.2", "3M"},
                                              {"5.2", "1.5 A"},
                                              {"5.2", "10 V"},
                                              {"5.2", "0.30 to 0.35 m"},
                                              {"5.2", "0.2 s"},
                                              {"5.2", "0.34 m"},
                                              {"5.2", "0.3 s"},
                                              {"5.2", "20 deg"},
                                              {"5.2", "60 deg"},
                                              {"5.2", "0.282 m"},
                                              {"5.2", "0.15 m"},
                                              {"5.2", "13 cm"},
                                              {"5.2", "7 cm"},
                                              {"5.2", "10 cm of leg"},
                                              {"5.2", "P = 0.4 s"},
                                              {"5.2", "up to 10 cm"},
                                              {"5.2", "700 g"},
                                              {"5.2", "1 kg"},
                                              {"5.2", "0.35 J"},
                                              {"5.2", "3 J"},
                                              // 6.1
                                              {"6.1.1", "2 mm"},
                                              {"6.1.1", "60"},
                                              {"6.1.1", "5"},
                                              {"6.1.1", "7 mm"},
                                              {"6.1.1", "20"},
                                              {"6.1.1", "below 2 mm"},
                                              {"5.2, Fig. 5.11", "10 N m"}};  // in 6.1.2 too

/// How many figures each chapter has.
struct Figures {
  int chapter, count;
};
inline constexpr Figures kFigures002[] = {{3, 7}, {4, 20}, {5, 11}};

/// What is no result, by its row's `what`.
inline const std::vector<std::string_view> kPutIn002{
    "leg at 20 deg",
    "leg at 60 deg",
    "the leg shortens by at most",
    "b of the printed masses, centres half-way",
    "constant torque of 1.2 N m: apex",
    "harmonic torque of 2.2 N m: apex",
    "2.7 N less the weight of 0.2 kg of lower links: pretension",
    "damped natural frequency of the printed k, m and ds",
    "1 kg, 40 ms: held after the command to catch",
    "the slowest of 100 varied trials",
    "smallest gain of holding load per gain of pressing force",
    "k A^2 / 2 for 10 cm",
    "coil at 10 V and 1.5 A for that flight",
    "break-even by the document's accounting"};

}  // namespace furcula::test
