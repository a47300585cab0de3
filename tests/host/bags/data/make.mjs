// Makes the bags of this folder with the libraries of others: @mcap/core writes the files, @foxglove/rosmsg2-serialization the messages,
// sqlite3, zstd and lz4 (Debian) the databases and compressed parts. The tests need none of them: what it made is in the repository.
//
//   npm install --no-save @mcap/core @foxglove/rosmsg @foxglove/rosmsg2-serialization
//   node make.mjs arm.csv            # arm.csv: a log that `furcula sim` wrote, cut to 80 rows
//   node make.mjs log RUN.csv OUT    # a log as one MCAP file
//   node make.mjs large OUT MESSAGES # a large MCAP file of joint states, to measure with
import { McapWriter } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { execFileSync } from "node:child_process";
import { createWriteStream, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";

const TIME = "================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const HEADER = `================\nMSG: std_msgs/Header\n# Time and frame\nbuiltin_interfaces/Time stamp\nstring frame_id\n${TIME}`;
const TYPES = {
  "sensor_msgs/msg/JointState": `# State of joints\n\nstd_msgs/Header header\n\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n${HEADER}`,
  "sensor_msgs/msg/Imu":
    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance # row major\n" +
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n" +
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n" +
    "================\nMSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n" +
    `================\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n${HEADER}`,
  "std_msgs/msg/Float64MultiArray":
    "MultiArrayLayout layout\nfloat64[] data\n================\nMSG: std_msgs/MultiArrayLayout\n" +
    "MultiArrayDimension[] dim\nuint32 data_offset\n================\nMSG: std_msgs/MultiArrayDimension\n" +
    "string label\nuint32 size\nuint32 stride\n",
  // A type that no reader knows: only its definition tells what it holds.
  "arm_msgs/msg/DriveState":
    "uint8 MODE_OFF=0\nuint8 MODE_ON = 1\nstd_msgs/Header header\nuint8 mode 1\nbool[2] brakes\nstring<=16 label\n" +
    "int16 ticks\nPhase[] phases\nfloat32 volts\nint64 count\n" +
    `================\nMSG: arm_msgs/Phase\nfloat32 amps\n${HEADER}`,
};
const writers = Object.fromEntries(
  Object.entries(TYPES).map(([type, text]) => [type, new MessageWriter(parse(text, { ros2: true }))]),
);
const T0 = 1732672000n * 1000000000n;
const stamp = (ns) => ({ sec: Number(ns / 1000000000n), nanosec: Number(ns % 1000000000n) });
const header = (ns) => ({ stamp: stamp(ns), frame_id: "base" });
const pipe = (command, ...words) => (bytes) => new Uint8Array(execFileSync(command, words, { input: bytes, maxBuffer: 1 << 30 }));
const zstd = pipe("zstd", "-q", "-c");
const lz4 = pipe("lz4", "-q", "-c", "-z");

/** messages: [topic, type, log time, object]; a type without a definition is JSON. */
async function mcap(path, messages, options = {}) {
  const parts = [];
  let size = 0n;
  const file = options.stream ? createWriteStream(path) : undefined;
  const writable = {
    async write(bytes) {
      size += BigInt(bytes.byteLength);
      if (options.stream) await new Promise((done) => file.write(Buffer.from(bytes), done));
      else parts.push(Buffer.from(bytes));
    },
    position: () => size,
  };
  const writer = new McapWriter({ writable, ...options.writer });
  await writer.start({ profile: "ros2", library: "make.mjs" });
  const channels = new Map();
  let sequence = 0;
  for (const [topic, type, log, object] of messages) {
    if (!channels.has(topic)) {
      const text = TYPES[type];
      const schema = text
        ? { name: type, encoding: "ros2msg", data: Buffer.from(text) }
        : { name: type, encoding: options.schemaEncoding ?? "jsonschema", data: Buffer.from('{"type":"object"}') };
      const schemaId = type === "" ? 0 : await writer.registerSchema(schema);
      channels.set(topic, await writer.registerChannel({
        topic, schemaId, messageEncoding: options.messageEncoding ?? (text ? "cdr" : "json"), metadata: new Map(),
      }));
    }
    let data = TYPES[type] ? writers[type].writeMessage(object) : Buffer.from(JSON.stringify(object));
    if (options.compressMessages) data = zstd(data);
    await writer.addMessage({ channelId: channels.get(topic), sequence: sequence++, logTime: log, publishTime: log, data });
  }
  await writer.end();
  if (!options.stream) writeFileSync(path, Buffer.concat(parts));
  file?.end();
}

// The tables as rosbag2_storage_sqlite3 of ROS 2 Humble makes them; `defined`: as since Iron, with the types' definitions.
function db3(path, messages, compress = (bytes) => bytes, defined = false) {
  rmSync(path, { force: true });
  const topics = [...new Map(messages.map(([topic, type]) => [topic, type]))];
  let sql =
    "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);\n" +
    "CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,metadata TEXT NOT NULL);\n" +
    "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL" + (defined ? ",type_description_hash TEXT NOT NULL" : "") + ");\n" +
    "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL);\n" +
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);\n" +
    (defined
      ? "INSERT INTO schema VALUES(4,'jazzy');\nCREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,encoding TEXT NOT NULL,encoded_message_definition TEXT NOT NULL,type_description_hash TEXT NOT NULL);\n"
      : "INSERT INTO schema VALUES(3,'humble');\n");
  topics.forEach(([topic, type], i) => {
    sql += `INSERT INTO topics VALUES(${i + 1},'${topic}','${type}','cdr',''${defined ? ",''" : ""});\n`;
    if (defined) sql += `INSERT INTO message_definitions VALUES(${i + 1},'${type}','ros2msg','${TYPES[type]}','');\n`;
  });
  for (const [topic, type, log, object] of messages) {
    const data = Buffer.from(compress(writers[type].writeMessage(object))).toString("hex");
    sql += `INSERT INTO messages(topic_id,timestamp,data) VALUES(${topics.findIndex(([t]) => t === topic) + 1},${log},x'${data}');\n`;
  }
  execFileSync("sqlite3", [path], { input: `PRAGMA page_size=1024;BEGIN;\n${sql}COMMIT;` });
}

const jointState = (ns, name, position, velocity = [], effort = []) => ({ header: header(ns), name, position, velocity, effort });

async function large(path, count) {
  const names = ["hip", "knee", "ankle", "waist", "shoulder", "elbow", "wrist"];
  function* messages() {
    for (let i = 0; i < count; ++i) {
      const ns = T0 + BigInt(i) * 1000000n;
      const q = names.map((_, k) => Math.sin(0.001 * i * (k + 1)));
      yield ["/joint_states", "sensor_msgs/msg/JointState", ns + 300000n, jointState(ns, names, q, q.map((v) => 0.5 * v), q.map((v) => 2 * v))];
    }
  }
  await mcap(path, messages(), { stream: true, writer: { useChunks: true, chunkSize: 4 << 20 } });
}

const ZSTD = { useChunks: true, chunkSize: 4096, compressChunk: (d) => ({ compression: "zstd", compressedData: zstd(d) }) };

/** A log of the double pendulum as messages: joint states and commands. */
function messagesOf(csv) {
  const lines = readFileSync(csv, "utf8").split("\n").filter((l) => l && !l.startsWith("#"));
  const columns = lines[0].split(",");
  const rows = lines.slice(1).map((l) => Object.fromEntries(l.split(",").map((v, i) => [columns[i], Number(v)])));
  const out = [];
  rows.forEach((r, i) => {
    const ns = T0 + BigInt(Math.round(r.time_s * 1e9));
    // The order of names changes, as it may.
    const names = i % 3 === 1 ? ["elbow", "shoulder"] : ["shoulder", "elbow"];
    out.push(["/joint_states", "sensor_msgs/msg/JointState", ns + 700000n, jointState(ns, names, names.map((n) => r[`angle_${n}_rad`]), [], names.map((n) => r[`torque_${n}_nm`]))]);
    out.push(["/effort_controller/commands", "std_msgs/msg/Float64MultiArray", ns, { layout: { dim: [], data_offset: 0 }, data: [r.torque_cmd_shoulder_nm, r.torque_cmd_elbow_nm] }]);
  });
  return out;
}

async function all(csv) {
  const JS = "sensor_msgs/msg/JointState";
  const arm = messagesOf(csv);
  await mcap("arm.mcap", arm, { writer: ZSTD });
  const few = arm.slice(0, 40);
  await mcap("plain.mcap", few, { writer: { useChunks: false, useStatistics: false, useSummaryOffsets: false, repeatSchemas: false, repeatChannels: false } });
  await mcap("chunks.mcap", few, { writer: { useChunks: true, chunkSize: 1500 } });
  await mcap("lz4.mcap", few, { writer: { useChunks: true, chunkSize: 3000, compressChunk: (d) => ({ compression: "lz4", compressedData: lz4(d) }) } });
  await mcap("unknown_compression.mcap", few.slice(0, 2), { writer: { useChunks: true, compressChunk: (d) => ({ compression: "xz", compressedData: d }) } });
  await mcap("messages_zstd.mcap", few, { compressMessages: true, writer: { useChunks: false } });
  writeFileSync("whole.mcap.zstd", zstd(readFileSync("plain.mcap")));
  await mcap("two_robots.mcap", few.flatMap(([, , log, m], i) => i % 2 ? [] : [["/left/joint_states", JS, log, m], ["/right/joint_states", JS, log, m]]));
  await mcap("commands.mcap", few.flatMap(([topic, , log, m], i) => topic !== "/joint_states" ? [] : [["/joint_commands", JS, log - 700000n, { ...m, position: m.position.map((q) => q + 1), effort: [] }], ["/joint_states", JS, log, m]]), { writer: ZSTD });
  await mcap("protobuf.mcap", [["/state", "arm.State", T0, {}]], { schemaEncoding: "protobuf", messageEncoding: "protobuf" });

  // Rows at 4 ms; an IMU at 5 ms, whose rate is 3 t and acceleration 10 - t; a switch; a type of the robot's own; JSON.
  const mixed = [];
  for (let i = 0; i < 50; ++i) {
    const ns = T0 + BigInt(i) * 4000000n, t = 0.004 * i;
    mixed.push(["/joint_states", JS, ns + 2000000n, jointState(ns, ["hip"], [0.5 * t], [0.5], [NaN])]);
    if (i >= 10 && i % 10 === 0) mixed.push(["/hip/command", "std_msgs/msg/Float64MultiArray", ns + 1000000n, { layout: { dim: [{ label: "joint", size: 1, stride: 1 }], data_offset: 0 }, data: [i] }]);
  }
  for (let i = 0; i < 40; ++i) {
    const ns = T0 + BigInt(i) * 5000000n, t = 0.005 * i, nine = new Float64Array(9);
    mixed.push(["/imu", "sensor_msgs/msg/Imu", ns + 2000000n, { header: header(ns), orientation: { x: 0, y: 0, z: 0, w: 1 }, orientation_covariance: nine, angular_velocity: { x: 3 * t, y: 0, z: 0 }, angular_velocity_covariance: nine, linear_acceleration: { x: 0, y: 0, z: 10 - t }, linear_acceleration_covariance: nine }]);
    mixed.push(["/drive", "arm_msgs/msg/DriveState", ns + 2000000n, { header: header(ns), mode: 1, brakes: [i >= 20, false], label: "a".repeat(i % 5), ticks: -i, phases: [{ amps: 0.5 }, { amps: -0.25 }], volts: 24.5, count: 10n * BigInt(i) }]);
    mixed.push(["/state", "State", ns, { foot: { force: [i, 2 * i], touches: i >= 30 }, label: "x", none: null }]);
  }
  mixed.sort((a, b) => (a[2] < b[2] ? -1 : a[2] > b[2] ? 1 : 0));
  await mcap("mixed.mcap", mixed, { writer: { useChunks: true, compressChunk: (d) => ({ compression: "zstd", compressedData: zstd(d) }) } });
  db3("defined.db3", mixed.filter(([topic]) => topic === "/joint_states" || topic === "/drive").slice(0, 30), zstd, true);
  await mcap("no_joints.mcap", mixed.filter(([topic]) => topic !== "/joint_states"), { writer: { useChunks: true, compressChunk: (d) => ({ compression: "zstd", compressedData: zstd(d) }) } });

  // A simulation that is reset after 30 rows, with an IMU beside.
  const reset = mixed.filter(([topic]) => topic === "/joint_states" || topic === "/imu").map(([topic, type, log, m]) => {
    const after = log > T0 + 120000000n;
    return [topic, type, log, { ...m, header: header(log - T0 + (after ? -100000000n : 10000000000n)) }];
  });
  await mcap("reset.mcap", reset, { writer: { useChunks: true, compressChunk: (d) => ({ compression: "zstd", compressedData: zstd(d) }) } });

  // An arm and its gripper publish on one topic.
  const partial = [];
  for (let i = 0; i < 40; ++i) {
    const ns = T0 + BigInt(i) * 4000000n;
    partial.push(["/joint_states", JS, ns, jointState(ns, ["shoulder", "elbow"], [0.01 * i, 0.02 * i])]);
    if (i % 2 === 0) partial.push(["/joint_states", JS, ns + 1000000n, jointState(ns, ["finger"], [i])]);
  }
  await mcap("partial.mcap", partial, { writer: { useChunks: true, compressChunk: (d) => ({ compression: "zstd", compressedData: zstd(d) }) } });

  mkdirSync("bag", { recursive: true });
  db3("bag/bag_0.db3", few.slice(0, 20));
  db3("bag/bag_1.db3", few.slice(20));
  const metadata = (files, mode) =>
    "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  relative_file_paths:\n" +
    files.map((f) => `    - ${f}\n`).join("") + `  duration:\n    nanoseconds: 79000000\n  compression_format: "${mode ? "zstd" : ""}"\n  compression_mode: "${mode}"\n`;
  writeFileSync("bag/metadata.yaml", metadata(["bag_0.db3", "bag_1.db3"], ""));
  mkdirSync("bag_zstd", { recursive: true });
  db3("bag_zstd/all.db3", few);
  writeFileSync("bag_zstd/all_0.db3.zstd", zstd(readFileSync("bag_zstd/all.db3")));
  rmSync("bag_zstd/all.db3");
  writeFileSync("bag_zstd/metadata.yaml", metadata(["all_0.db3.zstd"], "FILE"));
  db3("messages_zstd.db3", few.slice(0, 20), zstd);
}

if (process.argv[2] === "log") await mcap(process.argv[4], messagesOf(process.argv[3]), { writer: { ...ZSTD, chunkSize: 1 << 20 } });
else if (process.argv[2] === "large") await large(process.argv[3], Number(process.argv[4]));
else await all(process.argv[2]);
