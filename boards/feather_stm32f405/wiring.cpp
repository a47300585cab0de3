// Adafruit Feather STM32F405 Express (STM32F405RG, crystal 12 MHz, no debugger: flashed over USB): what is on
// which pin of its two rows. The names in the comments are those printed on the board.
#include "firmware/chip/stm32f4/wiring.hpp"

namespace furcula::stm32f4 {

constexpr Wiring kTable{
    .crystal_hz = 12'000'000,
    // Alternate functions: DS8626 table 9.
    .height = {address::kTim3, {{'C', 6}, 2}, {{'C', 7}, 2}},                // D6, D5
    .cable = {address::kTim4, {{'B', 6}, 2}, {{'B', 7}, 2}},                 // SCL, SDA
    .contact = {'C', 3},                                                     // D11
    .coil = {address::kTim13, 1, {{'A', 6}, 9}},                             // A2
    .can = {{{'B', 8}, 9}, {{'B', 9}, 9}},                                   // D9, D10
    .serial = {address::kUsart3, {{'B', 11}, 7}, {{'B', 10}, 7}, {'C', 2}},  // RX, TX, D12
    .led = {'C', 1},                                                         // D13, red
    // Both encoders are on this board.
    .link = {.height_node = 0, .cable_node = 0},
};
static_assert(is_sound(kTable));

constinit const Wiring kWiring = kTable;

}  // namespace furcula::stm32f4
