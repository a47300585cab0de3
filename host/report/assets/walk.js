// Draws the biped of #walk-data as it walks: lines and feet, forces of the ground, passive joints in their own colour, on a plain canvas that turns.
// Where the data has models, the robot is the measured one, and over it are those that the models predict; `off`: their points less its own.
(function () {
  'use strict';
  var data = JSON.parse(document.getElementById('walk-data').textContent);
  var element = function (id) { return document.getElementById(id); };
  var canvas = element('walk-canvas'), paper = canvas.getContext('2d');
  var HOME = {turn: -0.9, tilt: 0.2, zoom: 1};
  var view = {turn: HOME.turn, tilt: HOME.tilt, zoom: HOME.zoom};
  var frames = data.frames, begin = data.models ? frames[0].time : 0, time = data.start || begin, playing = false, last = null, waiting = false;
  var end = frames[frames.length - 1].time;
  var LEG = ['#0072b2', '#56a3cf'], BODY = '#4b5864', PASSIVE = '#e69f00', ACTIVE = '#1f2933', FORCE = '#0b7a53', MARK = '#d55e00';
  var MODELS = [{colour: '#3d4852', wide: 1.6, dash: [5, 4]}, {colour: '#0072b2', wide: 2.4, dash: []}];
  if (data.models) {
    LEG = ['#b4bfc9', '#d3dbe2'];
    BODY = '#c3cdd6';
    ACTIVE = '#8d99a5';
  }

  // Points of a moment between two frames.
  function moment() {
    var low = 0, high = frames.length - 1;
    while (high - low > 1) {
      var middle = (low + high) >> 1;
      if (frames[middle].time <= time) low = middle; else high = middle;
    }
    var a = frames[low], b = frames[high];
    var share = b.time > a.time ? Math.min(Math.max((time - a.time) / (b.time - a.time), 0), 1) : 0;
    var mix = function (p, q) { return p.map(function (v, i) { return v + (q[i] - v) * share; }); };
    // Predictions begin anew with each window: across its edges they are not mixed.
    var near = share < 0.5 ? a : b, same = a.off && b.off && a.phase === b.phase;
    var off = same ? a.off.map(function (o, m) { return o.map(function (p, i) { return mix(p, b.off[m][i]); }); }) : near.off || [];
    return {points: a.points.map(function (p, i) { return mix(p, b.points[i]); }), force: mix(a.force, b.force),
            phase: data.models ? near.phase : a.phase, off: off};
  }

  // Edges of the soles.
  var FEET = [4, 11].reduce(function (all, ankle) {
    return all.concat([[1, 2], [2, 4], [4, 3], [3, 1]].map(function (e) { return [ankle + e[0], ankle + e[1]]; }));
  }, []);

  // Rings about the joints that are marked, their texts at the side that they are on.
  function mark(p, project, size) {
    var lines = {};
    paper.font = (size.width < 560 ? 12 : 14) + 'px system-ui, sans-serif';
    paper.textBaseline = 'middle';
    (data.marked || []).forEach(function (m) {
      var a = project(p[m[0]]), n = lines[m[0]] = (lines[m[0]] || 0) + 1, left = a[0] < size.width / 2, wide = paper.measureText(m[1]).width;
      var x = left ? Math.max(4, a[0] - 22 - wide) : Math.min(size.width - 4 - wide, a[0] + 22), y = a[1] + 17 * (n - 1);
      paper.strokeStyle = MARK;
      paper.lineWidth = 2.5;
      paper.beginPath();
      paper.arc(a[0], a[1], 11, 0, 2 * Math.PI);
      paper.stroke();
      paper.lineWidth = 4;
      paper.strokeStyle = '#fff';
      paper.strokeText(m[1], x, y);
      paper.fillStyle = MARK;
      paper.fillText(m[1], x, y);
    });
  }

  function draw() {
    waiting = false;
    var size = window.furculaCanvas.fit(canvas);
    if (!size) return;
    var width = size.width, height = size.height;
    paper.lineCap = paper.lineJoin = 'round';
    var m = moment(), p = m.points;
    var centre = [p[0][0], data.models ? p[0][1] : 0, 0.62], away = 5, focal = view.zoom * Math.min(width / 1.5, height / 1.6) * away;
    var project = window.furculaCanvas.camera(view, centre, away, focal, size);
    var line = function (from, to, colour, wide) {
      var a = project(from), b = project(to);
      paper.strokeStyle = colour;
      paper.lineWidth = wide;
      paper.beginPath();
      paper.moveTo(a[0], a[1]);
      paper.lineTo(b[0], b[1]);
      paper.stroke();
    };
    var dot = function (at, radius, colour) {
      var a = project(at);
      paper.fillStyle = colour;
      paper.beginPath();
      paper.arc(a[0], a[1], radius, 0, 2 * Math.PI);
      paper.fill();
    };
    // The ground: squares of half a metre.
    var first = Math.floor(2 * centre[0]) - 6, aside = Math.round(2 * centre[1]);
    for (var i = 0; i <= 12; ++i) line([(first + i) / 2, aside / 2 - 1.5, 0], [(first + i) / 2, aside / 2 + 1.5, 0], '#e2e8ed', 1);
    for (var k = aside - 3; k <= aside + 3; ++k) line([first / 2, k / 2, 0], [first / 2 + 6, k / 2, 0], k ? '#e2e8ed' : '#c3cdd6', 1);

    // Pelvis 0, its top 1; of each leg hip, knee, ankle and the foot's four corners.
    var legs = [0, 1].map(function (side) { return {side: side, at: 2 + 7 * side}; });
    legs.sort(function (a, b) { return project(p[b.at])[2] - project(p[a.at])[2]; });
    legs.forEach(function (leg, order) {
      var q = p.slice(leg.at, leg.at + 7), colour = LEG[leg.side];
      if (order === 1) {
        line(p[0], p[1], BODY, 16);
        dot(p[1], 9, BODY);
      }
      line(p[0], q[0], BODY, 8);
      line(q[0], q[1], colour, 9);
      line(q[1], q[2], colour, 8);
      paper.fillStyle = colour;
      paper.strokeStyle = colour;
      paper.lineWidth = 2;
      paper.beginPath();
      [3, 4, 6, 5].forEach(function (c, n) {
        var a = project(q[c]);
        if (n) paper.lineTo(a[0], a[1]); else paper.moveTo(a[0], a[1]);
      });
      paper.closePath();
      paper.globalAlpha = 0.35;
      paper.fill();
      paper.globalAlpha = 1;
      paper.stroke();
      [3, 4, 5, 6].forEach(function (c) { line(q[2], q[c], colour, 2); });
      dot(q[0], 7, data.passive ? PASSIVE : ACTIVE);
      dot(q[1], 6, ACTIVE);
      dot(q[2], 5, ACTIVE);
      var f = m.force.slice(3 * leg.side, 3 * leg.side + 3);
      if (f[2] > 1) line(q[2], [q[2][0] + f[0] / 1000, q[2][1] + f[1] / 1000, q[2][2] + f[2] / 1000], FORCE, 3);
    });
    var scale = data.models ? Number(element('walk-scale').value) : 0;
    m.off.forEach(function (off, i) {
      var look = MODELS[i], q = p.map(function (at, k) { return at.map(function (v, n) { return v + scale * off[k][n]; }); });
      paper.setLineDash(look.dash);
      [[0, 1], [0, 2], [2, 3], [3, 4], [0, 9], [9, 10], [10, 11]].concat(FEET).forEach(function (pair) {
        line(q[pair[0]], q[pair[1]], look.colour, look.wide);
      });
      paper.setLineDash([]);
    });
    mark(p, project, size);
    element('walk-time').textContent = time.toFixed(2) + ' s, ' + m.phase;
    element('walk-slider').value = time;
  }
  function soon() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  }
  function tick(now) {
    if (!playing) return;
    if (last !== null) time += Math.min(now - last, 200) / 1000 * Number(element('walk-speed').value);
    last = now;
    if (time >= end) {
      time = end;
      play(false);
    }
    soon();
    requestAnimationFrame(tick);
  }
  function play(on) {
    playing = on;
    element('walk-play').textContent = on ? 'Pause' : 'Play';
    if (!on) return;
    if (time >= end) time = begin;
    last = null;
    requestAnimationFrame(tick);
  }
  element('walk-play').onclick = function () { play(!playing); };
  if (data.models) element('walk-scale').onchange = soon;
  var slider = element('walk-slider');
  slider.min = begin;
  slider.max = end;
  slider.step = 0.01;
  slider.oninput = function () { time = Number(slider.value); soon(); };
  element('walk-home').onclick = function () {
    view = {turn: HOME.turn, tilt: HOME.tilt, zoom: HOME.zoom};
    soon();
  };
  var held = null;
  canvas.onpointerdown = function (e) { held = [e.clientX, e.clientY]; if (canvas.setPointerCapture) try { canvas.setPointerCapture(e.pointerId); } catch (ignored) { /* a made-up pointer */ } };
  canvas.onpointerup = canvas.onpointercancel = function () { held = null; };
  canvas.onpointermove = function (e) {
    if (!held) return;
    view.turn -= (e.clientX - held[0]) * 0.008;
    view.tilt = Math.min(Math.max(view.tilt + (e.clientY - held[1]) * 0.008, -0.1), 1.55);
    held = [e.clientX, e.clientY];
    soon();
  };
  canvas.addEventListener('wheel', function (e) {
    e.preventDefault();
    view.zoom = Math.min(Math.max(view.zoom * Math.exp(-e.deltaY * 0.001), 0.3), 8);
    soon();
  }, {passive: false});
  window.addEventListener('resize', soon);
  window.furculaWalk = {
    at: function (t) { play(false); time = t; draw(); return moment(); },
    view: function () { return view; }
  };
  draw();
})();
