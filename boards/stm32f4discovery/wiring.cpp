// STM32F4DISCOVERY (MB997, STM32F407VG, crystal 8 MHz, ST-LINK on board): what is on which pin. The pins are
// those that UM1472 table 7 shows as not used on the board, but for PD14, its red lamp, and PB3, which is the
// debugger's trace.
#include "firmware/chip/stm32f4/wiring.hpp"

namespace furcula::stm32f4 {

constexpr Wiring kTable{
    .crystal_hz = 8'000'000,
    // Alternate functions: DS8626 table 9.
    .height = {address::kTim2, {{'A', 15}, 1}, {{'B', 3}, 1}},
    .cable = {address::kTim3, {{'B', 4}, 2}, {{'B', 5}, 2}},
    .contact = {'E', 7},
    .coil = {address::kTim9, 1, {{'E', 5}, 3}},
    .can = {{{'D', 0}, 9}, {{'D', 1}, 9}},
    .serial = {address::kUsart2, {{'A', 3}, 7}, {{'A', 2}, 7}, {'A', 1}},
    .led = {'D', 14},
    // Both encoders are on this board.
    .link = {.height_node = 0, .cable_node = 0},
};
static_assert(is_sound(kTable));

constinit const Wiring kWiring = kTable;

}  // namespace furcula::stm32f4
