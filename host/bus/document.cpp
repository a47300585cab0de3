// The page on the bus, see document.hpp.
#include "host/bus/document.hpp"

#include <cstdio>

#include "furcula/bus/walker_nodes.hpp"
#include "host/bus/nodes.hpp"
#include "host/bus/numbers.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::rounded;

constexpr std::string_view kHead = R"(# The CAN bus

Classical CAN, 1 Mbit/s, 11-bit ids. This page is what `furcula bus docs` prints; the table itself is
`common/include/furcula/bus/messages.hpp`, and codec, decoder and DBC file follow from it.

    furcula bus dbc > furcula.dbc            # for other tools: SavvyCAN, cantools, Wireshark, …
    furcula bus decode can.log > can.csv     # a recording of `candump -L can0 > can.log`, one row a signal
    furcula bus log can.log --out run.csv    # the same recording as a log, one row a tick, for check, identify and diagnose

All take the nodes of the bus as `--node NAME=PROTOCOL:ID`, once for each, and for a motor `--node NAME=mini_cheetah:ID:MOTOR`; without
it: )";

constexpr std::string_view kRecordings = R"(
## Recordings

Record with `candump -L can0 > can.log`. What is read:

| format | of |
| --- | --- |
| log: `(SECONDS) INTERFACE ID#DATA` | `candump -L`, `-l`, `-f`, with `-x`, `-8`, nanoseconds (1 to 9 decimals); python-can's `.log` |
| screen: `(SECONDS)  INTERFACE  ID   [LENGTH]  BYTES` | `candump -ta`, `-tA`, `-tz`, `-td`, with `-x`, `-8`, `-i`, `-a`, `-S`, `-e`, `-c`, `-d`; `log2long` |
| Vector's text, `.asc` | CANoe, CANalyzer, `log2asc`, python-can |

- Frames of CAN FD and CAN XL, remote frames, error frames, unknown ids and wrong lengths are counted and not decoded.
- A line that is no frame is left out, and the first three are named; of programs' messages (`read: Network is down`) it is said what to look at. A torn last line is left out and said. More than 3 and a twentieth of the lines, or as many as there are frames, are status 3.
- Stamps of `-tz` and `-td` look alike: they are taken as differences where most are smaller than an earlier one. A recording without time stamps is status 3.
- Other files (`.blf`, `.mf4`, `.trc`, `.pcap`, UTF-16, compressed ones) are status 3, with the way to convert them.

## From a recording to a log

`furcula bus log` makes a log `furcula-log/1` ([contracts](contracts.md)) of a recording, which it reads twice. A row is a frame of the encoder's `Sample`, at the instant of its content: stamp less age. For a hopper:

| column | from | in a row |
| --- | --- | --- |
| `height_m` | `Sample.Count` of the first `encoder` node | of the frame |
| `torque_cmd_nm` | `Command.Torque` of the first `mini_cheetah` drive | sent before the next `Sample`; a lost one is the row before's |
| `leg_angle_rad`, `torque_nm` | `Reply.Position`, `Reply.Torque` of that drive | came before the next `Sample`; a lost one is interpolated |
| `contact`, `solenoid` | `Leg_State` of the first `controller` node, every 10 ms | a change is taken in the middle between two frames: 5 ms early or late at most |

What a count is in metres, and the zero, sense and gear between drive and leg, follow from `Body_State.Height` and `Leg_State.Leg_Angle`, which the board tells of the same numbers. The command says what it found, held, interpolated, lost and left out.
Rows with the drive off are left out, because somebody then holds the robot. Each time that it is switched on is a run with a file of its own: `run.csv`, `run-2.csv` and so on. A delay of the contact switch of a few milliseconds does not show in such a log.

Other machines:

    furcula bus log can.log --out run.csv --rig rotary_joint --joint angle=Axis
    furcula bus log can.log --out run.csv --rig tree --joint knee=Knee --joint hip=Axis:-6      # turns of the motor to one of the joint
    furcula bus log can.log --out run.csv --rig motor_axis --column position_m=Axis.Get_Encoder_Estimates.Position*0.01 --column force_n=Axis.Set_Input_Torque.Torque*628.3

A row is then a reply of the first drive, and values of the others are interpolated to its instant:

- **When a reply was measured.** If a drive answers, it was measured when it was asked: at the stamp of the command, or of the remote frame that asks an ODrive. A message is taken for an answer if, but for a twentieth of its frames, one frame to its node came since the frame before it, within 1 ms, and nearer to this frame than to the one before. What is sent at times of its own was measured at its own stamp. The command says which message answers which.
- **Commands.** A row holds what acted from the row to the next: the mean over this time, which gives the same impulse, wherever in it the commands came. Of a whole number (a mode, a switch) it is what acted longest. A lost command's row holds the one before.
- **An ODrive that does not send `Get_Torques`** is refused on a `rotary_joint`, with the signal of the recording that can stand for it: `--column torque_nm=Axis.Set_Input_Torque.Torque`. Then what the drive does wrong counts as the robot's.

Frames of CAN FD, remote and error frames, unknown ids and wrong lengths are counted, as by `furcula bus decode`.

`--column NAME=NODE.MESSAGE.SIGNAL*SCALE+OFFSET` adds a column or takes the place of one.

## Rules
)";

constexpr std::string_view kRules = R"(
Ids of nodes are from 1 to 31. In the tables an id is given for node `n`; the start bit is that of a DBC file, big-endian signals start at their most
significant bit; a physical value is the raw number times the factor, plus the offset. What is put into a frame and out of its range is clamped to the nearest end and
reported; what is not a finite number is refused.

Messages of `controller`, `encoder` and `walker` carry the protocol's version ()";

constexpr std::string_view kStream =
    R"(), a sequence number of their own for each kind, and the age of their content when they were sent. A receiver
(`bus/stream.hpp`) takes what is fresh, tells a message that came again or out of order, counts what was lost, and takes nothing that is older than allowed or of another
version. A sender that was silent for 100 ms counts as started anew. Heartbeat, `Gyro` and `Walk_State` have no age; `Identity`, `Unique_Id` and `Logged_Fault`, which hardly change, have neither age nor number: ten
of them a second come in turn, so that all of them came after 1.2 s.

## Stop

A `Command` frame that says `stop` is obeyed whoever sends it, in any order, at any age, of any version and of any length that holds its first byte, on the tick after it came. `Request` is in this place, and 1 is
`stop`, in every version. One that is not the next frame of the stream is no part of it: it leaves the stream's numbers alone, and nothing starts for 100 ms after it. So is the request `stop` in `Register_Request`,
in any version, without key and session.

Another desk's stream that goes on saying `hop` does not start the robot again. It has to let go: for 100 ms nobody says `hop`, in whatever order, and then comes a `hop` that directly follows a frame of the same stream
which said something else. A frame does not say who sent it: a desk that is interrupted by another one's numbers at this instant has to let go once more.

## Registers over CAN

With `Register_Request` and `Register_Answer` a desk reads and writes the whole table of [registers](modbus.md), as over Modbus: the same code answers, with the same bounds, refusals
and exceptions. It is the pattern of ODrive's and CANopen's parameter access (SDO): one request, one answer.

    furcula monitor --port can:can0          # node 1; another one: can:can0@2
    furcula param set torque_amplitude_nm 2 --port can:can0
    furcula bench release-catch --board can:can0 --out trial

What one request reads is of one tick, and is sent two registers a frame, one frame a millisecond: 71 input registers take 37 ms. The answer's frames carry the request's sequence
number and the address of their registers, so that a lost one is a gap: ask again, with another sequence number. A desk waits 100 ms for the next frame of what it reads, 1 s for what it
writes (a board is silent while it saves), and asks three times. One desk at a time: a new request takes the place of the one that is being answered.

What holds, whoever sends what:

- **Flood.** A node does one request and sends one frame of an answer in a tick, and its worst tick is measured so. Both ids are behind those of drive, encoders and commands: on the
  wire those go first. Of the requests that come in one millisecond the last one is done; but a `stop` is done whatever comes with it.
- **While it runs** what Modbus refuses is refused: parameters are not written, and only `stop` acts. A desk that falls silent stops the robot after
  `desk_silent_s`; a repeated request that is not done does not count as one.
- **Repeated and recorded frames.** A request has key and session, as over Modbus, and its session is used up. The frame of the last request, heard again, is answered as it was and not
  done again, so that a desk whose answer was lost can repeat it; an older one is refused. `stop` needs neither and is done each time.
- What is shorter than 8 bytes, of another version or of no operation is counted and not answered; but for a `stop`, which is done and answered in each version.
)";

constexpr std::string_view kMotorsHead = R"(
## Motors with the mini-cheetah's packing

| motor | position, rad | velocity, rad/s | torque, N m | kp, N m/rad | kd, N m s/rad | bytes of a reply |
| --- | --- | --- | --- | --- | --- | --- |
)";

constexpr std::string_view kSources = R"(
A value in the middle between two steps goes to the lower one, so that zero is `7FFF` and `7FF`: a command of zeros is `7F FF 7F F0 00 00 07 FF`. The drives' own
code cuts off instead of going to the nearest step; both differ by one step at most.

## Sources, and where they disagree

- **Ranges** are those of CubeMars' "AK Series Actuator Driver Manual" V1.0.8, table on pages 49 and 50; its last column is headed AK80-80 there and taken for the
  AK80-64, whose manual it is. The sample code on the same page has other ones (position ±95.5, velocity ±30, torque ±18). Published drivers have, for the AK10-9, ±54 N m with
  ±23.24 rad/s, and ±16 N m with ±46.57 rad/s; for the AK60-6 ±9 N m with ±41.87 rad/s, and ±15 N m with ±50 rad/s; for the AK80-9 ±18 N m with ±41.87 rad/s. A wrong range scales
  every torque: read the range from the drive's own configuration before the first run, and try a small torque against a spring balance.
- **The mini-cheetah's** velocity range is ±65 rad/s in B. Katz's HKC_MiniCheetah and ±45 rad/s in other copies of that code; its comments
  speak of ±30 rad/s, ±4 pi and, in a reply, of ±40 A, which its constants are not.
- **A reply's length** is 6 bytes in B. Katz's firmware. The manual says 6 bytes (page 49) above a table of 8, with temperature and error code. Both lengths are read.
- **A reply's id** is the master's in B. Katz's firmware, a setting of the drive, with the motor's id in the first byte; the manual says "0x00 + drive ID", which could not be
  told from a command. This project reads id 0: set the drive's master id so.
- **A reply's current** (the manual's word) is a torque: it has the torque's range.
- **ODrive**: the set is that of firmware 0.6. In files for 0.5 and before, heartbeat bytes 5 to 7 are other flags or none, command 3 is `Get_Motor_Error`, 0x15
  `Get_Sensorless_Estimates`, and 0x17 in the oldest the voltage alone. `Clear_Errors` had no data there; both lengths are read. `Set_Axis_State` and `Set_Input_Torque` are 8 bytes long in
  ODrive's own library; frames of 4, which hold all that is in them, are read as well. Node id 0, ODrive's default, is not used here: its messages would have the ids of mini-cheetah
  motors. A remote frame with the id of a `Get_…` message asks for it.
)";

std::string id_rule(const Message& m) {
  char text[40];
  switch (m.rule) {
    case IdRule::fixed:
      std::snprintf(text, sizeof text, "`0x%03X`, first byte `n`", static_cast<unsigned>(m.base));
      break;
    case IdRule::plus_node:
      std::snprintf(text, sizeof text, "`0x%03X + n`", static_cast<unsigned>(m.base));
      break;
    case IdRule::odrive:
      std::snprintf(text, sizeof text, "`n << 5 | 0x%02X`", static_cast<unsigned>(m.base));
      break;
  }
  return text;
}

std::string_view sender(const Message& m) {
  switch (m.sender) {
    case Sender::desk:
      return "the desk";
    case Sender::controller:
      return "the controller";
    case Sender::node:
      return "the node";
  }
  return "";
}

std::string scale(const Signal& s) {
  switch (s.ranged) {
    case Ranged::position:
    case Ranged::velocity:
    case Ranged::torque:
      return "from - to + the motor's";
    case Ranged::stiffness:
    case Ranged::damping:
      return "from 0 to the motor's";
    case Ranged::no:
      break;
  }
  if (s.encoding == Encoding::real) return "IEEE 754";
  if (s.span == s.counts && s.unit.empty()) return "";
  return "x " + decimal(factor(s)) + ", " + decimal(lowest(s)) + " to " + decimal(highest(s));
}

std::string message_text(const Message& m) {
  std::string out = "\n### " + std::string(m.name) + "\n\n" + std::string(m.meaning) + " Id " + id_rule(m) +
                    "; from " + std::string(sender(m)) + "; " + std::to_string(m.size) + " bytes";
  if (m.least_size != m.size) out += ", or " + std::to_string(m.least_size);
  if (m.marker != 0) {
    char byte[8];
    std::snprintf(byte, sizeof byte, "%02X", static_cast<unsigned>(m.marker));
    return out + ": `FF FF FF FF FF FF FF " + byte + "`.\n";
  }
  out += ".\n";
  if (m.signals.empty()) return out;
  out +=
      "\n| signal | unit | start bit, width | order | scale | meaning |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const Signal& s : m.signals)
    out += "| `" + std::string(s.name) + "` | " + std::string(s.unit) + " | " + std::to_string(s.start_bit) +
           ", " + std::to_string(s.width) + (s.encoding == Encoding::signed_integer ? ", signed" : "") +
           " | " + (s.order == ByteOrder::little ? "little-endian" : "big-endian") + " | " + scale(s) +
           " | " + std::string(s.meaning) + " |\n";
  return out;
}

constexpr std::string_view kWalkerHead = R"(
## The biped's twelve drives

A frame of 8 bytes takes 135 bits with all the stuffing that there can be (`common/include/furcula/bus/load.hpp`), and a drive takes two of them, command and reply, each time. IMU, feet and pins are on the board itself, or on a third bus (below).

| buses | drives on each | rate | worst load of each |
| --- | --- | --- | --- |
)";

constexpr std::string_view kWalkerNodes = R"(
The biped has a bus a leg at 500 Hz: an STM32F405 has two CAN controllers. Three drives of each leg have their turn in even ticks of 1 ms, the others in odd ones; a drive holds its target between. With a desk's command each 10 ms and the board's heartbeat the left leg's bus comes to )";

constexpr std::string_view kWalkerBody =
    R"(A board without an IMU of its own, as `furculad`, has a third bus, the body's, with a node of the protocol `walker`, the desk, and what the board tells of itself: a leg's bus has no room for an IMU. Its worst load is )";

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

std::string walker_text() {
  std::string out(kWalkerHead);
  struct Arrangement {
    std::uint32_t buses, hz;
  };
  const auto drives = static_cast<std::uint32_t>(kWalkerDrives.size());
  for (const Arrangement& a : {Arrangement{1, 1000}, Arrangement{2, 1000}, Arrangement{4, 1000},
                               Arrangement{2, 500}, Arrangement{1, 250}}) {
    const double load = walker_load(drives / a.buses, a.hz);
    out += "| " + std::to_string(a.buses) + " | " + std::to_string(drives / a.buses) + " | " +
           std::to_string(a.hz) + " Hz | " + percent(load) + (load > 1.0 ? ": does not hold it" : "") +
           " |\n";
  }
  const std::array<Traffic, 4> left{{{&message::kMotorCommand, drives / 2 * kWalkerDrive_hz},
                                     {&message::kMotorReply, drives / 2 * kWalkerDrive_hz},
                                     {&message::kCommand, 100},
                                     {&message::kHeartbeat, 10}}};
  out += std::string(kWalkerNodes) + percent(worst_load(left)) + ".\n\n" + std::string(kWalkerBody) +
         percent(worst_load(kWalkerBodyTraffic)) +
         ".\n\n| joint | bus | id | motor |\n| --- | --- | --- | --- |\n";
  for (const WalkerDrive& d : kWalkerDrives)
    out += "| `" + std::string(d.joint) + "` | " + std::to_string(d.bus) + " | " + std::to_string(d.node) +
           " | `" + std::string(info(kWalkerMotor).name) + "` |\n";
  return out;
}

}  // namespace

std::string to_markdown() {
  std::string out(kHead);
  const char* between = "";
  for (const Node& n : usual_nodes()) {
    out += between + ("`" + n.name) + "=" + std::string(name_of(n.protocol)) + ":" + std::to_string(n.id) +
           (n.protocol == Protocol::mini_cheetah ? ":" + std::string(info(n.motor).name) : "") + "`";
    between = ", ";
  }
  out += ".\n" + std::string(kRecordings) + std::string(kRules) + std::to_string(kProtocolVersion) +
         std::string(kStream);
  for (const Protocol p : {Protocol::controller, Protocol::encoder, Protocol::mini_cheetah, Protocol::odrive,
                           Protocol::walker}) {
    out += "\n## Protocol `" + std::string(name_of(p)) + "`\n";
    for (const Message* m : kMessages)
      if (m->protocol == p) out += message_text(*m);
  }
  out += kMotorsHead;
  for (const MotorInfo& m : kMotors) {
    const auto text = [](float x) { return rounded(static_cast<double>(x)); };
    out += "| `" + std::string(m.name) + "` | ±" + text(m.position_max_rad) + " | ±" +
           text(m.velocity_max_radps) + " | ±" + text(m.torque_max_nm) + " | 0 to " +
           text(m.stiffness_max_nmpr) + " | 0 to " + text(m.damping_max_nmspr) + " | " +
           std::to_string(m.reply_bytes) + " |\n";
  }
  return out + walker_text() + std::string(kSources);
}

}  // namespace furcula::bus
