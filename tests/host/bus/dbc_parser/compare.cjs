// Decodes a candump log with candied and a DBC file, and compares every signal with the rows of `furcula bus decode`:
//   node compare.cjs FURCULA.dbc RECORDED.log OURS.csv
//
// Two things candied 2.2.0 leaves to its user, or does in its own way:
// - it reads SIG_VALTYPE_ (dataType 'float'), but gives the bits of such a signal as an integer;
// - it takes the start bit of a big-endian signal for that of its least significant bit, where a DBC file has the most
//   significant one. It is handed the bit that it means; the file's own start bit, width and order come from its parser.
'use strict';
const fs = require('fs');
const { Dbc, Can } = require('candied');

const [dbcPath, logPath, csvPath] = process.argv.slice(2);
const findings = [];
const expect = (holds, what) => { if (!holds) findings.push(what); };

const dbc = new Dbc();
const data = dbc.load(fs.readFileSync(dbcPath, 'utf8'));
expect(dbc.errors.size === 0, `candied reports ${dbc.errors.size} errors in ${dbcPath}`);
// What the parser did not understand is not in its result.
const signalsInFile = fs.readFileSync(dbcPath, 'utf8').match(/^ SG_ /gm).length;
let signalsParsed = 0;
const byId = new Map();
for (const message of data.messages.values()) {
  byId.set(message.id, message);
  signalsParsed += message.signals.size;
}
expect(signalsParsed === signalsInFile, `candied sees ${signalsParsed} of ${signalsInFile} signals`);

const can = new Can();
function decode(signal, payload) {
  const asItMeans = { ...signal };
  if (signal.endian === 'Motorola') {
    const last = 8 * Math.floor(signal.startBit / 8) + (7 - (signal.startBit % 8)) + signal.length - 1;
    asItMeans.startBit = 8 * Math.floor(last / 8) + (7 - (last % 8));
  }
  const decoded = can.decodeSignal(payload, asItMeans);
  if (signal.dataType !== 'float') return decoded.value;
  const view = new DataView(new ArrayBuffer(4));
  view.setUint32(0, signal.signed ? decoded.rawValue >>> 0 : decoded.rawValue);
  return view.getFloat32(0);
}

// Ours, a list of [time, message, signal, value, unit] for each frame; two frames of one message never share a time.
const ours = new Map();
for (const line of fs.readFileSync(csvPath, 'utf8').trim().split('\n').slice(1)) {
  const [time, , message, signal, value, unit] = line.split(',');
  if (!ours.has(time)) ours.set(time, []);
  ours.get(time).push({ message, signal, value: Number(value), unit });
}

// To float precision; candied clamps to the range that the file gives, whose ends are rounded.
const same = (a, b) => Object.is(a, b) || (Number.isNaN(a) && Number.isNaN(b)) ||
  Math.abs(a - b) <= 2e-7 * Math.max(Math.abs(a), Math.abs(b)) + 1e-9;

let compared = 0;
const seen = new Set();
for (const line of fs.readFileSync(logPath, 'utf8').trim().split('\n')) {
  const [, time, id, hex] = /^\((\d+\.\d+)\) \S+ ([0-9A-F]+)#([0-9A-F]*)$/.exec(line);
  const rows = ours.get(String(time)) || [];
  const message = byId.get(parseInt(id, 16));
  if (!message) { findings.push(`${line}: candied knows no such id`); continue; }
  const payload = (hex.match(/../g) || []).map((byte) => parseInt(byte, 16));
  expect(payload.length === message.dlc, `${line}: ${message.dlc} bytes in the DBC file`);
  if (rows.length === 1 && rows[0].signal === '') {
    // No signals; the special frames of a motor share the id of its command.
    expect(message.signals.size === 0 || /^F{14}F[CDE]$/.test(hex), `${line}: we decode no signal`);
    seen.add(message.name);
    continue;
  }
  expect(rows.length === message.signals.size, `${line}: ${rows.length} signals of ${message.signals.size}`);
  for (const row of rows) {
    // Replies of all motors are one message in the file, with the node in the signals' names.
    const node = row.message.split('_')[0];
    const shared = message.name === 'Motor_Reply';
    expect(shared || row.message === message.name, `${line}: ${row.message}, in the file ${message.name}`);
    const signal = message.signals.get(row.signal) || (shared && message.signals.get(`${node}_${row.signal}`));
    if (!signal) { findings.push(`${line}: no signal ${row.signal}`); continue; }
    const theirs = decode(signal, payload);
    expect(same(theirs, row.value), `${line}: ${row.signal}: candied ${theirs}, ours ${row.value}`);
    expect(signal.unit === row.unit, `${line}: ${row.signal}: unit ${signal.unit}, ours ${row.unit}`);
    compared += 1;
  }
  seen.add(message.name);
}
for (const message of data.messages.values()) expect(seen.has(message.name), `${message.name} is not in ${logPath}`);

for (const finding of findings.slice(0, 20)) console.error(finding);
console.log(`${compared} values of ${seen.size} messages compared, ${findings.length} findings`);
process.exit(findings.length === 0 && compared > 0 ? 0 : 1);
