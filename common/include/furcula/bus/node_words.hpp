// The words of a node that people and programs talk to: its states, what it can be asked, why it refused, and
// why it does not move. Each number, name and meaning stands here once; both buses and the host use them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace furcula::bus {

// Numbers of these enumerations are stable: they go over the bus.

/// State of a node; meanings: kNodeStates.
enum class NodeState : std::uint8_t { starting = 0, idle = 1, running = 2, fault = 3, armed = 4 };

/// What a node can be asked to do; meanings: kRequests.
enum class Request : std::uint8_t {
  none = 0,
  stop = 1,
  hop = 2,
  reset = 3,
  arm = 4,
  home = 5,
  save = 6,
  load_defaults = 7,
};

/// Why a write or request was refused; meanings: kRefusals.
enum class Refusal : std::uint8_t {
  none = 0,
  unknown_request = 1,
  wrong_key = 2,
  wrong_session = 3,
  not_in_this_state = 4,
  not_on_the_ground = 5,
  value_not_allowed = 6,
  makes_no_sense = 7,
  store_failed = 8,
  no_edge = 9,
  stop_stands = 10,
  saved_too_often = 11,
  store_worn = 12,
  supply_low = 13,
  brown_out_off = 14,
  beyond_envelope = 15,
};

/// Why the robot does not move; meanings: kReasons.
enum class Reason : std::uint8_t {
  none = 0,
  starting = 1,
  fault = 2,
  idle = 3,
  stopped = 4,
  armed = 5,
  arming_expired = 6,
  stream_silent = 7,
  no_torque = 8,
  flight = 9,
  trial = 10,
  trial_ended = 11,
  host_silent = 12,
  landing = 13,
  standing_still = 14,
};

/// Where the parameters come from; meanings: kParameterOrigins.
enum class ParameterOrigin : std::uint8_t {
  defaults = 0,
  store = 1,
  store_unusable = 2,
  changed = 3,
  being_saved = 4
};

/// Why the node started; meanings: kResetCauses.
enum class ResetCause : std::uint8_t { unknown = 0, power = 1, pin = 2, software = 3, watchdog = 4 };

/// A row of one of the tables below: the text for one enumerator.
struct Word {
  std::uint8_t number;       ///< the enumerator's value and the row's index
  std::string_view name;     ///< as in telemetry and commands; the enumerator's
  std::string_view meaning;  ///< one or two sentences for the documentation and messages
};

/// Names and meanings of NodeState.
inline constexpr std::array<Word, 5> kNodeStates{{
    {0, "starting", "Waits until the sensors have answered without a fault for a while. Torque 0."},
    {1, "idle", "Torque 0, coil off. Parameters may be written."},
    {2, "running", "The controller commands drive and coil."},
    {3, "fault", "Torque 0, coil off, until a reset after the fault's cause is gone."},
    {4, "armed", "Torque 0, coil off; hop is taken for a bounded time."},
}};

/// Names and meanings of Request.
inline constexpr std::array<Word, 8> kRequests{{
    {0, "none", "Nothing."},
    {1, "stop", "Torque 0 at once. Taken in every state, without key and session."},
    {2, "hop", "Starts the controller. Taken when armed."},
    {3, "reset", "Clears the fault, if its cause is gone. Not taken when armed or running."},
    {4, "arm", "Makes ready to hop. Taken when idle."},
    {5, "home",
     "The robot stands on the ground: the height is what the leg says, the clutch's cable is at rest. On the "
     "bench: the load is at the top of its way. Not taken when armed or running."},
    {6, "save", "Keeps the parameters over a restart. Not taken when armed or running."},
    {7, "load_defaults", "The parameters as built in; not saved. Not taken when armed or running."},
}};

/// Names and meanings of Refusal.
inline constexpr std::array<Word, 16> kRefusals{{
    {0, "none", "Nothing was refused."},
    {1, "unknown_request", "There is no request of that number."},
    {2, "wrong_key", "The key was not the one of the table: a stray write."},
    {3, "wrong_session",
     "The session was not the one that the node shows: an old or repeated frame. Read it again."},
    {4, "not_in_this_state", "Not taken in the state that the node is in."},
    {5, "not_on_the_ground",
     "Homing needs a fresh sample of a robot whose contact switch is closed, with its leg angle; on the bench a fresh sample."},
    {6, "value_not_allowed", "A parameter's value is not a number, out of its bounds, or has a fraction."},
    {7, "makes_no_sense", "With these values together the controller's configuration makes no sense."},
    {8, "store_failed", "The parameters could not be saved."},
    {9, "no_edge",
     "A stream starts the robot only when its request changes to hop while it is fresh, after 100 ms without any hop."},
    {10, "stop_stands", "Within the last 100 ms somebody said stop beside the stream of commands."},
    {11, "saved_too_often",
     "Ten saves in a row, and then one each ten minutes: each wears the flash memory."},
    {12, "store_worn",
     "The flash memory has been erased as often as it bears: the board's chip must be changed."},
    {13, "supply_low",
     "The chip's supply is below 2.9 V: an erase of its flash memory could not be relied on."},
    {14, "brown_out_off",
     "The chip's option BOR_LEV is not at level 3: it would run on through a sag while it erases (adding_a_board.md)."},
    {15, "beyond_envelope",
     "The torque's amplitude, or its limit if that is less, would take the robot higher or faster than it may: "
     "write a smaller one, or torque_shape 0 first."},
}};

/// Names and meanings of Reason.
inline constexpr std::array<Word, 15> kReasons{{
    {0, "none", "Nothing holds it: the controller commands a torque."},
    {1, "starting", "It starts: it waits for sensors that answer without a fault."},
    {2, "fault", "A fault holds it in the safe state."},
    {3, "idle", "Nobody has told it to hop: arm it, then hop."},
    {4, "stopped", "It was told to stop: arm it, then hop."},
    {5, "armed", "It is armed and waits for hop."},
    {6, "arming_expired", "It was armed and no hop came in time: arm it again."},
    {7, "stream_silent", "The stream of commands that had started it fell silent."},
    {8, "no_torque",
     "Its torque has no shape, or an amplitude of 0: set torque_shape and torque_amplitude_nm."},
    {9, "flight", "It is in the air: the torque is 0 until touch-down."},
    {10, "trial", "It is on the clutch's bench, and a trial runs."},
    {11, "trial_ended", "The bench's trial is over and can be read: arm it, then hop, for the next one."},
    {12, "host_silent", "No host sent anything for host_timeout_s: arm it, then hop."},
    {13, "landing", "The contact switch is lost: it lands without it, and then is in that fault."},
    {14, "standing_still",
     "It stands still, and a constant torque acts only on a body that moves: lift it and let it fall, or set torque_shape to harmonic."},
}};

/// Names and meanings of ParameterOrigin.
inline constexpr std::array<Word, 5> kParameterOrigins{{
    {0, "defaults", "As built in: nothing was saved."},
    {1, "store", "As saved."},
    {2, "store_unusable", "As built in: what was saved is damaged or makes no sense."},
    {3, "changed", "Changed since the start or the last save, and not saved."},
    {4, "being_saved", "Being written to the file; then they are as saved, or last_refusal is store_failed."},
}};

/// Names and meanings of ResetCause.
inline constexpr std::array<Word, 5> kResetCauses{{
    {0, "unknown", "It cannot be told, as on a computer."},
    {1, "power", "Power came, or had sagged."},
    {2, "pin", "The reset button, or a debugger."},
    {3, "software", "The firmware itself, after an exception."},
    {4, "watchdog", "The watchdog: a task was stuck."},
}};

namespace table {
template <std::size_t N>
constexpr bool in_order(const std::array<Word, N>& words) {
  for (std::size_t i = 0; i < N; ++i)
    if (words[i].number != i) return false;
  return true;
}
}  // namespace table
static_assert(table::in_order(kNodeStates) && table::in_order(kRequests) && table::in_order(kRefusals) &&
                  table::in_order(kReasons) && table::in_order(kParameterOrigins) &&
                  table::in_order(kResetCauses),
              "the words stand in the order of their numbers");

/// Name and meaning of `x`, which is an enumerator.
constexpr const Word& info(NodeState x) { return kNodeStates[static_cast<std::size_t>(x)]; }
/// Name and meaning of `x`, which is an enumerator.
constexpr const Word& info(Request x) { return kRequests[static_cast<std::size_t>(x)]; }
/// Name and meaning of `x`, which is an enumerator.
constexpr const Word& info(Refusal x) { return kRefusals[static_cast<std::size_t>(x)]; }
/// Name and meaning of `x`, which is an enumerator.
constexpr const Word& info(Reason x) { return kReasons[static_cast<std::size_t>(x)]; }
/// Name and meaning of `x`, which is an enumerator.
constexpr const Word& info(ResetCause x) { return kResetCauses[static_cast<std::size_t>(x)]; }
/// Name and meaning of `x`, which is an enumerator.
constexpr const Word& info(ParameterOrigin x) { return kParameterOrigins[static_cast<std::size_t>(x)]; }

}  // namespace furcula::bus
