// The table of all messages on the bus. Codec, DBC file, documentation and decoder follow from it.
//
// Sources
//   mini_cheetah  CubeMars (T-Motor), "AK Series Actuator Driver Manual" V1.0.8, section 5.3, pages 48 and 49;
//                 B. Katz, HKC_MiniCheetah, CAN_com.cpp (pack_reply: 6 bytes, to the master's id)
//   odrive        ODrive Robotics, "CAN Protocol" (docs.odriverobotics.com, can-protocol.html), and the messages of
//                 firmware 0.6 in its ODriveArduino, src/can_simple_messages.hpp
//   the others    this project's own
// Where they disagree: docs/board_link.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "furcula/bus/message.hpp"

namespace furcula::bus {

/// Of the project's own messages; a receiver refuses what carries another.
inline constexpr std::uint8_t kProtocolVersion = 1;

namespace table {

constexpr Signal ranged(std::string_view name, std::string_view unit, std::uint8_t start, std::uint8_t width,
                        Ranged what, std::string_view meaning) {
  return {name, unit, start, width, ByteOrder::big, Encoding::unsigned_integer, meaning,
          1.0f, 1.0f, 0.0f,  what};
}
constexpr Signal code(std::string_view name, std::uint8_t start, std::uint8_t width,
                      std::string_view meaning) {
  return {name, "", start, width, ByteOrder::little, Encoding::unsigned_integer, meaning};
}
constexpr Signal real(std::string_view name, std::string_view unit, std::uint8_t start,
                      std::string_view meaning) {
  return {name, unit, start, 32, ByteOrder::little, Encoding::real, meaning};
}
/// A step is 1 / counts of the unit.
constexpr Signal fixed_point(std::string_view name, std::string_view unit, std::uint8_t start,
                             std::uint8_t width, Encoding encoding, float counts, std::string_view meaning) {
  return {name, unit, start, width, ByteOrder::little, encoding, meaning, 1.0f, counts};
}

// mini-cheetah

inline constexpr std::array<Signal, 5> kMotorCommand{{
    ranged("Position", "rad", 7, 16, Ranged::position, "Position that the stiffness pulls to."),
    ranged("Velocity", "rad/s", 23, 12, Ranged::velocity, "Velocity that the damping pulls to."),
    ranged("Stiffness", "N m/rad", 27, 12, Ranged::stiffness, "kp."),
    ranged("Damping", "N m s/rad", 47, 12, Ranged::damping, "kd."),
    ranged("Torque", "N m", 51, 12, Ranged::torque, "Torque added to that of stiffness and damping."),
}};
inline constexpr std::array<Signal, 6> kMotorReply{{
    {"Motor_Id", "", 7, 8, ByteOrder::big, Encoding::unsigned_integer, "Node id of the motor that replies."},
    ranged("Position", "rad", 15, 16, Ranged::position, "Measured at the output shaft."),
    ranged("Velocity", "rad/s", 31, 12, Ranged::velocity, "Measured at the output shaft."),
    ranged("Torque", "N m", 35, 12, Ranged::torque, "From the current; the manual calls it current."),
    {"Temperature", "degC", 55, 8, ByteOrder::big, Encoding::unsigned_integer,
     "As the drive sends it. Only in replies of 8 bytes."},
    {"Error", "", 63, 8, ByteOrder::big, Encoding::unsigned_integer, "0: none. Only in replies of 8 bytes."},
}};

// ODrive CAN Simple. An axis answers a remote frame with the same id and the data.

inline constexpr std::array<Signal, 4> kOdriveHeartbeat{{
    code("Axis_Error", 0, 32, "Flags; 0: none."),
    code("Axis_State", 32, 8, "1: idle, 3: calibration, 8: closed-loop control."),
    code("Procedure_Result", 40, 8, "Of the last calibration or homing; 0: success, 1: busy."),
    code("Trajectory_Done", 48, 1, "1: the trajectory has ended."),
}};
inline constexpr std::array<Signal, 2> kOdriveGetError{{
    code("Active_Errors", 0, 32, "Flags."),
    code("Disarm_Reason", 32, 32, "Flags of what disarmed the axis."),
}};
inline constexpr std::array<Signal, 1> kOdriveSetAxisState{{
    code("Axis_State", 0, 32, "1: idle, 3: calibration, 8: closed-loop control."),
}};
inline constexpr std::array<Signal, 2> kOdriveEncoderEstimates{{
    real("Position", "rev", 0, "Estimated."),
    real("Velocity", "rev/s", 32, "Estimated."),
}};
inline constexpr std::array<Signal, 2> kOdriveControllerMode{{
    code("Control_Mode", 0, 32, "0: voltage, 1: torque, 2: velocity, 3: position."),
    code("Input_Mode", 32, 32,
         "1: passed through, 2: velocity ramp, 5: trapezoidal trajectory, 6: torque ramp."),
}};
inline constexpr std::array<Signal, 3> kOdriveInputPosition{{
    real("Position", "rev", 0, "Set point."),
    fixed_point("Velocity", "rev/s", 32, 16, Encoding::signed_integer, 1000.0f,
                "Feed-forward; the step is the drive's default."),
    fixed_point("Torque", "N m", 48, 16, Encoding::signed_integer, 1000.0f,
                "Feed-forward; the step is the drive's default."),
}};
inline constexpr std::array<Signal, 2> kOdriveInputVelocity{{
    real("Velocity", "rev/s", 0, "Set point."),
    real("Torque", "N m", 32, "Feed-forward."),
}};
inline constexpr std::array<Signal, 1> kOdriveInputTorque{{real("Torque", "N m", 0, "Set point.")}};
inline constexpr std::array<Signal, 2> kOdriveIq{{
    real("Iq_Setpoint", "A", 0, "Commanded current along the q axis."),
    real("Iq_Measured", "A", 32, "Measured current along the q axis."),
}};
inline constexpr std::array<Signal, 2> kOdriveTemperature{{
    real("Fet_Temperature", "degC", 0, "Of the inverter."),
    real("Motor_Temperature", "degC", 32, "NaN or 0 where the motor has no sensor."),
}};
inline constexpr std::array<Signal, 2> kOdriveBusPower{{
    real("Bus_Voltage", "V", 0, "Of the supply."),
    real("Bus_Current", "A", 32, "Into the drive."),
}};
inline constexpr std::array<Signal, 1> kOdriveClearErrors{{
    code("Identify", 0, 8, "1: the drive blinks as well."),
}};
inline constexpr std::array<Signal, 2> kOdriveTorques{{
    real("Torque_Target", "N m", 0, "Commanded to the motor."),
    real("Torque_Estimate", "N m", 32, "From the current."),
}};

// This project's own. The first three bytes are the same in all that tell of a present state: version,
// sequence number, age.

constexpr Signal version() { return code("Protocol_Version", 0, 4, "Of this project's own messages."); }
constexpr Signal sequence() {
  return code("Sequence", 8, 8, "One more in each message of this kind, 0 after 255.");
}
/// 25.4 ms at most: an older one is 255.
constexpr Signal age() {
  return fixed_point("Age", "s", 16, 8, Encoding::unsigned_integer, 10000.0f,
                     "Of the content when it was sent; 0.0255: older than 0.0254.");
}

inline constexpr std::array<Signal, 5> kHeartbeat{{
    version(),
    code("State", 4, 4, "0: starting, 1: idle, 2: running, 3: safe state after a fault, 4: armed."),
    sequence(),
    code("Fault", 16, 8, "Number in the table of faults (docs/safety.md); 0: none."),
    fixed_point("Uptime", "s", 24, 32, Encoding::unsigned_integer, 1000.0f, "Since the start."),
}};
inline constexpr std::array<Signal, 7> kCommand{{
    version(),
    code("Request", 4, 4,
         "0: none, 1: stop (here in every version), 2: hop, of a biped walk, 3: reset the fault."),
    sequence(),
    age(),
    fixed_point("Torque_Amplitude", "N m", 24, 16, Encoding::signed_integer, 1000.0f,
                "Of the torque over a stance."),
    fixed_point("Torque_Period", "s", 40, 16, Encoding::unsigned_integer, 10000.0f,
                "Of the torque over a stance."),
    code("Clutch", 56, 1, "1: release the spring in flight."),
}};
inline constexpr std::array<Signal, 7> kBodyState{{
    version(),
    code("Phase", 4, 4, "0: flight, 1: stance."),
    sequence(),
    age(),
    code("Fault", 24, 8, "Number in the table of faults (docs/safety.md); 0: none."),
    fixed_point("Height", "m", 32, 16, Encoding::signed_integer, 10000.0f, "Of the body's centre of mass."),
    fixed_point("Velocity", "m/s", 48, 16, Encoding::signed_integer, 1000.0f, "Upwards."),
}};
inline constexpr std::array<Signal, 7> kLegState{{
    version(),
    code("Contact", 4, 1, "1: the debounced switch is closed."),
    code("Solenoid", 5, 1, "1: energised, the spring is released."),
    sequence(),
    age(),
    fixed_point("Leg_Angle", "rad", 24, 16, Encoding::signed_integer, 10000.0f, "On the motor's side."),
    fixed_point("Torque", "N m", 40, 16, Encoding::signed_integer, 1000.0f, "Commanded to the drive."),
}};
inline constexpr std::array<Signal, 5> kEncoderSample{{
    version(),
    code("Status", 4, 4, "0: good, 1: not homed, 2: no signal."),
    sequence(),
    age(),
    {"Count", "", 32, 32, ByteOrder::little, Encoding::signed_integer, "Of the encoder; it wraps."},
}};
/// Of a node that measures the supply of the motor's drive, for drives whose replies do not have it.
inline constexpr std::array<Signal, 5> kSupply{{
    version(),
    sequence(),
    age(),
    fixed_point("Voltage", "V", 24, 16, Encoding::unsigned_integer, 100.0f, "Of the drive's supply."),
    fixed_point("Current", "A", 40, 16, Encoding::signed_integer, 100.0f,
                "Into the drive; negative where the motor feeds back."),
}};

/// What does not change while it runs, and so has neither sequence number nor age.
inline constexpr std::array<Signal, 4> kIdentity{{
    version(),
    code("Reset_Cause", 4, 4, "Why it started: 0: unknown, 1: power, 2: pin, 3: software, 4: watchdog."),
    code("Firmware_Version", 8, 24, "65536 x major + 256 x minor + patch."),
    code("Build_Id", 32, 32, "Of the image, as the board's build gives it."),
}};
inline constexpr std::array<Signal, 3> kUniqueId{{
    version(),
    code("Part", 4, 4, "0: bits 0 to 31, 1: bits 32 to 63, 2: bits 64 to 95."),
    code("Bits", 8, 32, "Of the chip's number; all 0: it has none."),
}};
inline constexpr std::array<Signal, 5> kLoggedFault{{
    version(),
    code("Entry", 4, 4, "0 is the newest."),
    code("Fault", 8, 8, "Number in the table of faults (docs/safety.md); 0: there is no such entry."),
    code("Start", 16, 16, "The run: 1 is the first since the log was cleared."),
    fixed_point("Tick", "s", 32, 32, Encoding::unsigned_integer, 1000.0f,
                "Since that start; 4294967.295: not known."),
}};

/// The host's access to the table of registers, and its answer (register_frames.hpp, docs/modbus.md).
inline constexpr std::array<Signal, 5> kRegisterRequest{{
    version(),
    code(
        "Operation", 4, 4,
        "0: read input registers, 1: read holding registers, 2: write two holding registers, 3: request, 4: read a text."),
    code("Sequence", 8, 8, "Another one in each request; the answer has it too."),
    code("Address", 16, 16, "Of the first register; of a request the key."),
    code("Value", 32, 32,
         "To be read: how many registers, at most 125. To be written: both registers, the first one high. "
         "Of a request: 65536 x session + request. Of a text: the object of the device identification."),
}};
inline constexpr std::array<Signal, 5> kRegisterAnswer{{
    version(),
    code("Status", 4, 4, "0: done; else the exception, with the numbers of Modbus."),
    code("Sequence", 8, 8, "Of the request."),
    code("Address", 16, 16, "Of the first of both registers; of a text counted from 0."),
    code("Value", 32, 32,
         "Two registers, the first one high, the last one of an odd number alone; of a text four characters, "
         "and a 0 behind its last one. What was written, where nothing was read."),
}};

// A walking biped's body: IMU, feet, the pins of its clutches. What has three numbers of 16 bits has no room for an age.

constexpr Signal device_status() { return code("Status", 4, 4, "0: good, 2: no signal."); }
inline constexpr std::array<Signal, 6> kGyro{{
    version(),
    device_status(),
    sequence(),
    fixed_point("Rate_X", "rad/s", 16, 16, Encoding::signed_integer, 2000.0f, "Forward axis of the pelvis."),
    fixed_point("Rate_Y", "rad/s", 32, 16, Encoding::signed_integer, 2000.0f, "To the left."),
    fixed_point("Rate_Z", "rad/s", 48, 16, Encoding::signed_integer, 2000.0f, "Upwards."),
}};
inline constexpr std::array<Signal, 7> kAcceleration{{
    version(),
    device_status(),
    sequence(),
    age(),
    fixed_point("Acceleration_X", "m/s^2", 24, 13, Encoding::signed_integer, 25.0f,
                "Forward; what an accelerometer has: upwards 9.81 at rest."),
    fixed_point("Acceleration_Y", "m/s^2", 37, 13, Encoding::signed_integer, 25.0f, "To the left."),
    fixed_point("Acceleration_Z", "m/s^2", 50, 13, Encoding::signed_integer, 25.0f, "Upwards."),
}};
inline constexpr std::array<Signal, 6> kFeet{{
    version(),
    device_status(),
    sequence(),
    age(),
    fixed_point("Left", "N", 24, 16, Encoding::unsigned_integer, 10.0f,
                "Under the left sole; of a switch any force above the threshold."),
    fixed_point("Right", "N", 40, 16, Encoding::unsigned_integer, 10.0f, "Under the right sole."),
}};
constexpr Signal pin(std::string_view name, std::uint8_t start, std::string_view meaning) {
  return fixed_point(name, "", start, 8, Encoding::signed_integer, 100.0f, meaning);
}
inline constexpr std::array<Signal, 8> kPins{{
    version(),
    device_status(),
    sequence(),
    age(),
    pin("Left_Hip", 24, "Of the hip's pitch. 1: in the motor's rotator, 0: in neither, -1: in the spring's."),
    pin("Left_Knee", 32, "As above."),
    pin("Right_Hip", 40, "As above."),
    pin("Right_Knee", 48, "As above."),
}};
inline constexpr std::array<Signal, 7> kPinTargets{{
    version(),
    sequence(),
    age(),
    pin("Left_Hip", 24, "Where the pin's servo shall take it; numbers as in Pins."),
    pin("Left_Knee", 32, "As above."),
    pin("Right_Hip", 40, "As above."),
    pin("Right_Knee", 48, "As above."),
}};
inline constexpr std::array<Signal, 8> kWalkState{{
    version(),
    code("Stage", 4, 4,
         "0: idle, 1: joining, 2: walking, 3: damped after a fault, 4: exercising on the stand."),
    sequence(),
    code("Fault", 16, 8, "Number in the table of faults (docs/safety.md); 0: none."),
    code("Suspect", 24, 4, "The joint that the fault is of, from 0 on in the order of its ids; 12: none."),
    code("Phase", 28, 4, "Of the walk: 0: start, 1: up, 2: down, 3: stop."),
    fixed_point("Height", "m", 32, 16, Encoding::unsigned_integer, 10000.0f,
                "Of the pelvis over the lower sole."),
    fixed_point("Upright", "", 48, 16, Encoding::signed_integer, 10000.0f, "Cosine of the pelvis' tilt."),
}};

}  // namespace table

namespace message {

inline constexpr Message kMotorCommand{"Command",
                                       Protocol::mini_cheetah,
                                       IdRule::plus_node,
                                       0x000,
                                       8,
                                       Sender::controller,
                                       "Position, velocity, gains and torque of a motor.",
                                       table::kMotorCommand,
                                       8};
inline constexpr Message kMotorEnter{"Enter_Motor_Mode",
                                     Protocol::mini_cheetah,
                                     IdRule::plus_node,
                                     0x000,
                                     8,
                                     Sender::controller,
                                     "Switches the motor's control on; asks for a reply.",
                                     {},
                                     8,
                                     0xfc};
inline constexpr Message kMotorExit{"Exit_Motor_Mode",
                                    Protocol::mini_cheetah,
                                    IdRule::plus_node,
                                    0x000,
                                    8,
                                    Sender::controller,
                                    "Switches the motor's control off.",
                                    {},
                                    8,
                                    0xfd};
inline constexpr Message kMotorZero{"Set_Zero_Position",
                                    Protocol::mini_cheetah,
                                    IdRule::plus_node,
                                    0x000,
                                    8,
                                    Sender::controller,
                                    "Makes the present position the zero.",
                                    {},
                                    8,
                                    0xfe};
inline constexpr Message kMotorReply{"Reply",      Protocol::mini_cheetah,    IdRule::fixed,      0x000, 8,
                                     Sender::node, "Answer to each command.", table::kMotorReply, 6};

inline constexpr Message kOdriveHeartbeat{"Heartbeat",
                                          Protocol::odrive,
                                          IdRule::odrive,
                                          0x01,
                                          8,
                                          Sender::node,
                                          "State of the axis, every 100 ms.",
                                          table::kOdriveHeartbeat,
                                          8};
inline constexpr Message kOdriveEstop{
    "Estop", Protocol::odrive, IdRule::odrive, 0x02, 0, Sender::controller, "Disarms the axis at once.", {},
    0};
inline constexpr Message kOdriveGetError{"Get_Error",
                                         Protocol::odrive,
                                         IdRule::odrive,
                                         0x03,
                                         8,
                                         Sender::node,
                                         "Errors now, and those that disarmed.",
                                         table::kOdriveGetError,
                                         8};
inline constexpr Message kOdriveSetAxisState{"Set_Axis_State",
                                             Protocol::odrive,
                                             IdRule::odrive,
                                             0x07,
                                             8,
                                             Sender::controller,
                                             "Requests a state of the axis.",
                                             table::kOdriveSetAxisState,
                                             4};
inline constexpr Message kOdriveEncoderEstimates{"Get_Encoder_Estimates",
                                                 Protocol::odrive,
                                                 IdRule::odrive,
                                                 0x09,
                                                 8,
                                                 Sender::node,
                                                 "Position and velocity of the motor.",
                                                 table::kOdriveEncoderEstimates,
                                                 8};
inline constexpr Message kOdriveControllerMode{"Set_Controller_Mode",
                                               Protocol::odrive,
                                               IdRule::odrive,
                                               0x0b,
                                               8,
                                               Sender::controller,
                                               "What is controlled, and how inputs pass.",
                                               table::kOdriveControllerMode,
                                               8};
inline constexpr Message kOdriveInputPosition{"Set_Input_Pos",
                                              Protocol::odrive,
                                              IdRule::odrive,
                                              0x0c,
                                              8,
                                              Sender::controller,
                                              "Position with feed-forward.",
                                              table::kOdriveInputPosition,
                                              8};
inline constexpr Message kOdriveInputVelocity{"Set_Input_Vel",
                                              Protocol::odrive,
                                              IdRule::odrive,
                                              0x0d,
                                              8,
                                              Sender::controller,
                                              "Velocity with feed-forward.",
                                              table::kOdriveInputVelocity,
                                              8};
inline constexpr Message kOdriveInputTorque{"Set_Input_Torque",
                                            Protocol::odrive,
                                            IdRule::odrive,
                                            0x0e,
                                            8,
                                            Sender::controller,
                                            "Torque.",
                                            table::kOdriveInputTorque,
                                            4};
inline constexpr Message kOdriveIq{"Get_Iq",     Protocol::odrive, IdRule::odrive,   0x14, 8,
                                   Sender::node, "Motor current.", table::kOdriveIq, 8};
inline constexpr Message kOdriveTemperature{"Get_Temperature",
                                            Protocol::odrive,
                                            IdRule::odrive,
                                            0x15,
                                            8,
                                            Sender::node,
                                            "Temperatures.",
                                            table::kOdriveTemperature,
                                            8};
inline constexpr Message kOdriveBusPower{"Get_Bus_Voltage_Current",
                                         Protocol::odrive,
                                         IdRule::odrive,
                                         0x17,
                                         8,
                                         Sender::node,
                                         "Supply.",
                                         table::kOdriveBusPower,
                                         8};
inline constexpr Message kOdriveClearErrors{"Clear_Errors",
                                            Protocol::odrive,
                                            IdRule::odrive,
                                            0x18,
                                            1,
                                            Sender::controller,
                                            "Clears the errors of the axis.",
                                            table::kOdriveClearErrors,
                                            0};
inline constexpr Message kOdriveTorques{
    "Get_Torques", Protocol::odrive,        IdRule::odrive,        0x1c, 8,
    Sender::node,  "Torques of the motor.", table::kOdriveTorques, 8};

inline constexpr Message kCommand{"Command",
                                  Protocol::controller,
                                  IdRule::plus_node,
                                  0x400,
                                  8,
                                  Sender::host,
                                  "What the robot shall do; without a fresh one it stops.",
                                  table::kCommand,
                                  8};
inline constexpr Message kBodyState{"Body_State", Protocol::controller,     IdRule::plus_node, 0x420, 8,
                                    Sender::node, "Telemetry of the body.", table::kBodyState, 8};
inline constexpr Message kLegState{"Leg_State",  Protocol::controller,           IdRule::plus_node, 0x440, 7,
                                   Sender::node, "Telemetry of leg and clutch.", table::kLegState,  7};
inline constexpr Message kHeartbeat{"Heartbeat",
                                    Protocol::controller,
                                    IdRule::plus_node,
                                    0x700,
                                    7,
                                    Sender::node,
                                    "The node lives; every 100 ms.",
                                    table::kHeartbeat,
                                    7};
inline constexpr Message kIdentity{"Identity",
                                   Protocol::controller,
                                   IdRule::plus_node,
                                   0x480,
                                   8,
                                   Sender::node,
                                   "Who it is; this and the next two share ten frames a second, in turn.",
                                   table::kIdentity,
                                   8};
inline constexpr Message kUniqueId{"Unique_Id",  Protocol::controller,           IdRule::plus_node, 0x4a0, 5,
                                   Sender::node, "A part of its chip's number.", table::kUniqueId,  5};
inline constexpr Message kLoggedFault{"Logged_Fault",
                                      Protocol::controller,
                                      IdRule::plus_node,
                                      0x4c0,
                                      8,
                                      Sender::node,
                                      "An entry of its log of faults.",
                                      table::kLoggedFault,
                                      8};
inline constexpr Message kRegisterRequest{"Register_Request",
                                          Protocol::controller,
                                          IdRule::plus_node,
                                          0x4e0,
                                          8,
                                          Sender::host,
                                          "Reads or writes the table of registers, as Modbus does.",
                                          table::kRegisterRequest,
                                          8};
inline constexpr Message kRegisterAnswer{"Register_Answer",
                                         Protocol::controller,
                                         IdRule::plus_node,
                                         0x500,
                                         8,
                                         Sender::node,
                                         "Two registers; as many of them as it takes, one every millisecond.",
                                         table::kRegisterAnswer,
                                         8};
inline constexpr Message kEncoderSample{"Sample",
                                        Protocol::encoder,
                                        IdRule::plus_node,
                                        0x460,
                                        8,
                                        Sender::node,
                                        "One reading, every millisecond.",
                                        table::kEncoderSample,
                                        8};
inline constexpr Message kSupply{"Supply",
                                 Protocol::encoder,
                                 IdRule::plus_node,
                                 0x520,
                                 7,
                                 Sender::node,
                                 "The drive's supply, every millisecond.",
                                 table::kSupply,
                                 7};
inline constexpr Message kEncoderHeartbeat{"Heartbeat",
                                           Protocol::encoder,
                                           IdRule::plus_node,
                                           0x720,
                                           7,
                                           Sender::node,
                                           "The node lives; every 100 ms.",
                                           table::kHeartbeat,
                                           7};

inline constexpr Message kGyro{"Gyro",
                               Protocol::walker,
                               IdRule::plus_node,
                               0x540,
                               8,
                               Sender::node,
                               "Angular rates, every millisecond; their age is that of the Acceleration with "
                               "the same number, which follows.",
                               table::kGyro,
                               8};
inline constexpr Message kAcceleration{"Acceleration",
                                       Protocol::walker,
                                       IdRule::plus_node,
                                       0x560,
                                       8,
                                       Sender::node,
                                       "The other half of the IMU's sample.",
                                       table::kAcceleration,
                                       8};
inline constexpr Message kFeet{"Feet",
                               Protocol::walker,
                               IdRule::plus_node,
                               0x580,
                               7,
                               Sender::node,
                               "What the feet carry, every millisecond.",
                               table::kFeet,
                               7};
inline constexpr Message kPins{"Pins",
                               Protocol::walker,
                               IdRule::plus_node,
                               0x5a0,
                               7,
                               Sender::node,
                               "Where the clutches' pins are, every millisecond.",
                               table::kPins,
                               7};
inline constexpr Message kPinTargets{"Pin_Targets",
                                     Protocol::walker,
                                     IdRule::plus_node,
                                     0x5c0,
                                     7,
                                     Sender::controller,
                                     "Where the pins shall be, every 10 ms and when that changes.",
                                     table::kPinTargets,
                                     7};
inline constexpr Message kWalkState{"Walk_State",
                                    Protocol::walker,
                                    IdRule::plus_node,
                                    0x5e0,
                                    8,
                                    Sender::controller,
                                    "What the board does, every 10 ms and when its stage changes.",
                                    table::kWalkState,
                                    8};

}  // namespace message

/// Those with a marker stand before what has the same id without one.
inline constexpr std::array<const Message*, 37> kMessages{&message::kMotorEnter,
                                                          &message::kMotorExit,
                                                          &message::kMotorZero,
                                                          &message::kMotorCommand,
                                                          &message::kMotorReply,
                                                          &message::kOdriveHeartbeat,
                                                          &message::kOdriveEstop,
                                                          &message::kOdriveGetError,
                                                          &message::kOdriveSetAxisState,
                                                          &message::kOdriveEncoderEstimates,
                                                          &message::kOdriveControllerMode,
                                                          &message::kOdriveInputPosition,
                                                          &message::kOdriveInputVelocity,
                                                          &message::kOdriveInputTorque,
                                                          &message::kOdriveIq,
                                                          &message::kOdriveTemperature,
                                                          &message::kOdriveBusPower,
                                                          &message::kOdriveClearErrors,
                                                          &message::kOdriveTorques,
                                                          &message::kCommand,
                                                          &message::kBodyState,
                                                          &message::kLegState,
                                                          &message::kHeartbeat,
                                                          &message::kIdentity,
                                                          &message::kUniqueId,
                                                          &message::kLoggedFault,
                                                          &message::kRegisterRequest,
                                                          &message::kRegisterAnswer,
                                                          &message::kEncoderSample,
                                                          &message::kSupply,
                                                          &message::kEncoderHeartbeat,
                                                          &message::kGyro,
                                                          &message::kAcceleration,
                                                          &message::kFeet,
                                                          &message::kPins,
                                                          &message::kPinTargets,
                                                          &message::kWalkState};

/// For signals that are known when the program is compiled; a name that the message does not have does not
/// compile.
consteval const Signal& signal(const Message& message, std::string_view name) {
  const Signal* found = nullptr;
  for (const Signal& s : message.signals)
    if (s.name == name) found = &s;
  return *found;
}

}  // namespace furcula::bus
