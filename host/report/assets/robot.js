// Draws the robot of #robot-data: measured and simulated pose over a recording, on a plain canvas.
(function () {
  'use strict';
  var data = JSON.parse(document.getElementById('robot-data').textContent);
  var element = function (id) { return document.getElementById(id); };
  var canvas = element('robot-canvas'), paper = canvas.getContext('2d');
  var MEASURED = {line: '#5b6875', face: '91,104,117'}, SIMULATED = {line: '#0072b2', face: '0,114,178'};
  var GUILTY = {line: '#d55e00', face: '213,94,0'}, LOAD = '#8e44ad';
  var HOME = {turn: -0.7, tilt: 0.35, zoom: 1};
  var view = {turn: HOME.turn, tilt: HOME.tilt, zoom: HOME.zoom};
  var motion = null, time = 0, playing = false, last = null, waiting = false;

  // Rotations are nine numbers by rows: coordinates of the inner frame to those of the outer one.
  function times(a, b) {
    var out = [];
    for (var i = 0; i < 3; ++i)
      for (var k = 0; k < 3; ++k) out.push(a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k]);
    return out;
  }
  function turned(r, v) {
    return [r[0] * v[0] + r[1] * v[1] + r[2] * v[2], r[3] * v[0] + r[4] * v[1] + r[5] * v[2],
            r[6] * v[0] + r[7] * v[1] + r[8] * v[2]];
  }
  function plus(a, b) { return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]; }
  function scaled(a, k) { return [a[0] * k, a[1] * k, a[2] * k]; }
  function point(frame, v) { return plus(frame.at, turned(frame.turn, v)); }
  function within(outer, inner) { return {turn: times(outer.turn, inner.turn), at: point(outer, inner.at)}; }
  // Rodrigues' formula.
  function about(a, angle) {
    var s = Math.sin(angle), c = Math.cos(angle), k = 1 - c, x = a[0], y = a[1], z = a[2];
    return [c + x * x * k, x * y * k - z * s, x * z * k + y * s, x * y * k + z * s, c + y * y * k, y * z * k - x * s,
            x * z * k - y * s, y * z * k + x * s, c + z * z * k];
  }
  var WORLD = {turn: [1, 0, 0, 0, 1, 0, 0, 0, 1], at: [0, 0, 0]};

  // The frame of each joint's link, parents come first.
  function pose(positions) {
    var out = [];
    data.joints.forEach(function (j, i) {
      var q = positions[i];
      var moved = j.slides ? {turn: WORLD.turn, at: scaled(j.axis, q)} : {turn: about(j.axis, q), at: [0, 0, 0]};
      out.push(within(within(j.parent < 0 ? WORLD : out[j.parent], j), moved));
    });
    return out;
  }
  function positions(columns) {
    if (!motion) return data.rest;
    var t = motion.time, low = 0, high = t.length - 1;
    while (high - low > 1) {
      var middle = (low + high) >> 1;
      if (t[middle] <= time) low = middle; else high = middle;
    }
    var share = high > low ? Math.min(Math.max((time - t[low]) / (t[high] - t[low]), 0), 1) : 0;
    return columns.map(function (c, i) {
      var a = c[low], b = c[high];
      if (a === null || a === undefined) a = b;
      if (b === null || b === undefined) b = a;
      return a === null || a === undefined ? data.rest[i] : a + (b - a) * share;
    });
  }

  // A box's corner, 0 to 7, in its own axes.
  function corner(b, i) {
    return [i & 1 ? b.half[0] : -b.half[0], i & 2 ? b.half[1] : -b.half[1], i & 4 ? b.half[2] : -b.half[2]];
  }

  // What the robot reaches in its recordings: the middle of the picture, its size in metres, where the floor is.
  function measure() {
    var low = [0, 0, 0], high = [0, 0, 0];
    var take = function (columns) {
      var frames = pose(positions(columns));
      var of = function (joint) { return joint < 0 ? WORLD : frames[joint]; };
      var include = function (p) {
        p.forEach(function (v, i) {
          low[i] = Math.min(low[i], v);
          high[i] = Math.max(high[i], v);
        });
      };
      data.bones.forEach(function (b) {
        include(point(of(b.joint), b.from));
        include(point(of(b.joint), b.to));
      });
      data.boxes.forEach(function (b) {
        for (var i = 0; i < 8; ++i) include(point(within(of(b.joint), b), corner(b, i)));
      });
    };
    if (!data.motions.length) take();
    data.motions.forEach(function (m) {
      motion = m;
      for (var k = 0; k < 25; ++k) {
        time = m.time[Math.floor(k * (m.time.length - 1) / 24)];
        take(m.measured);
      }
    });
    data.centre = scaled(plus(low, high), 0.5);
    data.size = Math.max(Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]), 1e-3);
    data.floor = low[2] - 0.03 * data.size;
    var decade = Math.pow(10, Math.floor(Math.log10(data.size / 4)));
    data.grid = decade * ([1, 2, 5].filter(function (f) { return f * decade <= data.size / 4; }).pop() || 1);
  }

  // What a pose is made of: lines along the links, boxes of the inertias, rings about the joints' axes.
  function parts(frames, look, side, list, all) {
    var marks = [], first = list.length, base = {turn: WORLD.turn, at: side};
    var at = function (joint) { return joint < 0 ? base : {turn: frames[joint].turn, at: plus(frames[joint].at, side)}; };
    data.bones.forEach(function (b) {
      var frame = at(b.joint);
      list.push({kind: 'line', points: [point(frame, b.from), point(frame, b.to)], width: b.guilty ? 9 : 7,
                 colour: b.guilty ? GUILTY.line : b.joint < 0 ? '#9aa5b1' : look.line});
    });
    data.boxes.forEach(function (b) {
      var frame = within(at(b.joint), b), colour = b.guilty ? GUILTY : look;
      [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]].forEach(function (face) {
        list.push({kind: 'face', points: face.map(function (i) { return point(frame, corner(b, i)); }), fill: 'rgba(' + colour.face + ',.12)',
                   edge: 'rgba(' + colour.face + ',.4)'});
      });
      if (b.guilty) marks.push({at: frame.at, text: b.guilty});
    });
    data.loads.forEach(function (l) {
      var where = point(at(l.joint), l.at);
      list.push({kind: 'ball', points: [where], radius: 9, colour: LOAD});
    });
    if (data.base) marks.push({at: side, text: data.base});
    data.joints.forEach(function (j, i) {
      var frame = at(i), across = Math.abs(j.axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], ring = [], r = 0.03 * data.size;
      var u = [j.axis[1] * across[2] - j.axis[2] * across[1], j.axis[2] * across[0] - j.axis[0] * across[2],
               j.axis[0] * across[1] - j.axis[1] * across[0]];
      u = scaled(u, r / Math.hypot(u[0], u[1], u[2]));
      var colour = j.guilty ? GUILTY.line : look.line;
      for (var k = 0; k <= 24; ++k) ring.push(point(frame, turned(about(j.axis, k * Math.PI / 12), u)));
      if (!j.slides) list.push({kind: 'line', points: ring, width: 2.5, colour: colour});
      list.push({kind: 'line', points: [point(frame, scaled(j.axis, -1.6 * r)), point(frame, scaled(j.axis, 1.6 * r))],
                 width: j.slides ? 5 : 2.5, colour: colour});
      list.push({kind: 'ball', points: [frame.at], radius: j.guilty ? 6 : 4, colour: colour});
      if (j.guilty || element('robot-names').checked) marks.push({at: frame.at, text: j.guilty || j.name, plain: !j.guilty});
    });
    if (all) all.push({marks: marks, parts: list.slice(first)});
  }

  function draw() {
    waiting = false;
    var size = window.furculaCanvas.fit(canvas);
    if (!size) return;
    var width = size.width, height = size.height;

    var mode = motion ? element('robot-mode').value : 'simulated', list = [], marks = [];
    var gap = mode === 'beside' ? 0.5 * data.size : 0;
    var st = Math.sin(view.turn), ct = Math.cos(view.turn);
    var sideways = function (k) { return [ct * k, st * k, 0]; };  // across the view, so that neither hides the other
    var away = (gap ? 8 : 3.2) * data.size;  // from afar both are seen from one side
    var focal = view.zoom * Math.min(width * (gap ? 0.48 : 0.9), height * 1.05) / data.size * away;
    var project = window.furculaCanvas.camera(view, data.centre, away, focal, size);

    // The floor: a grid below the base.
    var step = data.grid, n = 5;
    paper.lineWidth = 1;
    for (var i = -n; i <= n; ++i)
      [[[i * step, -n * step, data.floor], [i * step, n * step, data.floor]],
       [[-n * step, i * step, data.floor], [n * step, i * step, data.floor]]]
          .forEach(function (pair) {
            var a = project(pair[0]), b = project(pair[1]);
            paper.strokeStyle = i ? '#e8edf1' : '#cfd8df';
            paper.beginPath();
            paper.moveTo(a[0], a[1]);
            paper.lineTo(b[0], b[1]);
            paper.stroke();
          });

    if (mode !== 'simulated') {
      // Names once where both poses are at one place.
      parts(pose(positions(motion.measured)), MEASURED, sideways(-gap), list, mode === 'measured' || gap ? marks : null);
    }
    if (mode !== 'measured') parts(pose(positions(motion ? motion.simulated : [])), SIMULATED, sideways(gap), list, marks);

    list.forEach(function (p) {
      p.drawn = p.points.map(project);
      p.depth = p.drawn.reduce(function (sum, q) { return sum + q[2]; }, 0) / p.drawn.length;
    });
    list.sort(function (a, b) { return b.depth - a.depth; });
    paper.lineJoin = paper.lineCap = 'round';
    list.forEach(function (p) {
      paper.beginPath();
      if (p.kind === 'ball') paper.arc(p.drawn[0][0], p.drawn[0][1], p.radius, 0, 2 * Math.PI);
      else p.drawn.forEach(function (q, k) { if (k) paper.lineTo(q[0], q[1]); else paper.moveTo(q[0], q[1]); });
      if (p.kind === 'face') paper.closePath();
      if (p.kind !== 'line') {
        paper.fillStyle = p.fill || p.colour;
        paper.fill();
      }
      if (p.kind !== 'ball') {
        paper.strokeStyle = p.edge || p.colour;
        paper.lineWidth = p.width || 1;
        paper.globalAlpha = p.kind === 'line' && mode === 'over' ? 0.75 : 1;
        paper.stroke();
        paper.globalAlpha = 1;
      }
    });
    if (!gap || width >= 700) label(marks, project, width, height);  // two robots and their names need room
    arrows(height);
    tell();
  }

  // Names beside the robot, on the side where they belong, moved down where they would lie over each other.
  function label(poses, project, width, height) {
    var taken = [], all = [];
    paper.font = '600 13px system-ui, sans-serif';
    paper.textBaseline = 'middle';
    poses.forEach(function (pose) {
      var left = width, right = 0;
      pose.parts.forEach(function (p) {
        p.drawn.forEach(function (q) {
          left = Math.min(left, q[0]);
          right = Math.max(right, q[0]);
        });
      });
      pose.marks.forEach(function (m) {
        m.drawn = project(m.at);
        m.left = left - 22;
        m.right = right + 22;
        m.isLeft = m.drawn[0] < 0.5 * (left + right) - 0.05 * (right - left);
        all.push(m);
      });
    });
    all.sort(function (a, b) { return a.drawn[1] - b.drawn[1]; });
    all.forEach(function (m) {
      var text = m.text.length > 60 ? m.text.slice(0, 59) + '…' : m.text;
      var w = paper.measureText(text).width, y = m.drawn[1];
      var isLeft = m.isLeft && m.left - w >= 6 || m.right + w > width - 6 && m.left - w >= 6;
      var x = isLeft ? m.left - w : Math.max(6, Math.min(m.right, width - 6 - w));
      var covers = function (t) { return Math.abs(t.y - y) < 19 && x < t.right && t.x < x + w; };
      for (var k = 0; k < 40 && taken.some(covers); ++k) y += 4;
      y = Math.min(Math.max(y, 12), height - 12);
      taken.push({x: x, right: x + w, y: y});
      paper.strokeStyle = m.plain ? '#8d99a5' : GUILTY.line;
      paper.lineWidth = 1;
      paper.beginPath();
      paper.moveTo(m.drawn[0], m.drawn[1]);
      paper.lineTo(isLeft ? x + w + 3 : x - 3, y);
      paper.stroke();
      paper.lineWidth = 4;
      paper.strokeStyle = 'rgba(251,252,253,.92)';
      paper.strokeText(text, x, y);
      paper.fillStyle = m.plain ? '#5b6875' : '#a84300';
      paper.fillText(text, x, y);
    });
  }

  // The world's axes in the corner.
  function arrows(height) {
    var st = Math.sin(view.turn), ct = Math.cos(view.turn), si = Math.sin(view.tilt), co = Math.cos(view.tilt);
    paper.font = '12px system-ui, sans-serif';
    paper.textBaseline = 'middle';
    [['x', [ct, -si * st], '#c0392b'], ['y', [st, si * ct], '#1e8449'], ['z', [0, co], '#1f4e9c']].forEach(function (a) {
      var x = 40, y = height - 40, dx = 26 * a[1][0], dy = -26 * a[1][1];
      paper.strokeStyle = paper.fillStyle = a[2];
      paper.lineWidth = 2;
      paper.beginPath();
      paper.moveTo(x, y);
      paper.lineTo(x + dx, y + dy);
      paper.stroke();
      paper.fillText(a[0], x + 1.35 * dx - 3, y + 1.35 * dy);
    });
  }

  // The joint that is furthest from what was measured, now.
  function tell() {
    if (!motion) return;
    var a = positions(motion.measured), b = positions(motion.simulated), worst = -1, most = 0;
    a.forEach(function (v, i) { if (Math.abs(v - b[i]) > most) { most = Math.abs(v - b[i]); worst = i; } });
    element('robot-time').textContent = time.toFixed(3) + ' s';
    element('robot-slider').value = time;
    element('robot-difference').textContent = worst < 0 ? '' : 'Furthest apart now: ' + data.joints[worst].name + ', ' +
        (1e3 * most).toPrecision(3) + (data.joints[worst].slides ? ' mm' : ' mrad');
  }

  function soon() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  }
  function tick(now) {
    if (!playing) return;
    if (last !== null) time += Math.min(now - last, 200) / 1000 * Number(element('robot-speed').value);
    last = now;
    var end = motion.time[motion.time.length - 1];
    if (time >= end) {
      time = end;
      play(false);
    }
    soon();
    requestAnimationFrame(tick);
  }
  function play(on) {
    if (!motion) return;
    playing = on;
    element('robot-play').textContent = on ? 'Pause' : 'Play';
    if (!on) return;
    if (time >= motion.time[motion.time.length - 1]) time = motion.time[0];
    last = null;
    requestAnimationFrame(tick);
  }
  function choose(i) {
    motion = data.motions[i];
    time = motion.time[0];
    var slider = element('robot-slider'), end = motion.time[motion.time.length - 1];
    slider.min = time;
    slider.max = end;
    slider.step = (end - time) / 2000 || 1;
    play(false);
    soon();
  }
  function zoom(by) {
    view.zoom = Math.min(Math.max(view.zoom * by, 0.3), 12);
    soon();
  }
  function turn(across, down) {
    view.turn -= across;
    view.tilt = Math.min(Math.max(view.tilt + down, -1.55), 1.55);
    soon();
  }

  // One pointer turns, two zoom.
  var pointers = {};
  function spread() {
    var p = Object.keys(pointers).map(function (k) { return pointers[k]; });
    return p.length < 2 ? 0 : Math.hypot(p[0].x - p[1].x, p[0].y - p[1].y);
  }
  canvas.addEventListener('pointerdown', function (e) {
    pointers[e.pointerId] = {x: e.clientX, y: e.clientY};
    if (canvas.setPointerCapture) try { canvas.setPointerCapture(e.pointerId); } catch (ignored) { /* a made-up pointer */ }
  });
  canvas.addEventListener('pointermove', function (e) {
    var p = pointers[e.pointerId];
    if (!p) return;
    var before = spread(), dx = e.clientX - p.x, dy = e.clientY - p.y;
    p.x = e.clientX;
    p.y = e.clientY;
    if (before > 0) zoom(spread() / before);
    else turn(dx * 0.008, dy * 0.008);
  });
  ['pointerup', 'pointercancel'].forEach(function (name) {
    canvas.addEventListener(name, function (e) { delete pointers[e.pointerId]; });
  });
  // The wheel is the page's, until the picture has been clicked.
  canvas.addEventListener('wheel', function (e) {
    if (document.activeElement !== canvas) return;
    e.preventDefault();
    zoom(Math.exp(-0.0015 * e.deltaY));
  }, {passive: false});
  canvas.addEventListener('keydown', function (e) {
    var does = {
      ArrowLeft: function () { turn(-0.1, 0); }, ArrowRight: function () { turn(0.1, 0); },
      ArrowUp: function () { turn(0, -0.1); }, ArrowDown: function () { turn(0, 0.1); },
      '+': function () { zoom(1.2); }, '=': function () { zoom(1.2); }, '-': function () { zoom(1 / 1.2); },
      ' ': function () { play(!playing); }, Home: home
    }[e.key];
    if (!does || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    does();
  });
  function home() {
    view = {turn: HOME.turn, tilt: HOME.tilt, zoom: HOME.zoom};
    soon();
  }

  element('robot-names').onchange = soon;
  element('robot-home').onclick = home;
  element('robot-nearer').onclick = function () { zoom(1.25); };
  element('robot-further').onclick = function () { zoom(0.8); };
  measure();
  if (data.motions.length) {
    data.motions.forEach(function (m, i) {
      var option = document.createElement('option');
      option.value = i;
      option.textContent = m.log;
      element('robot-log').appendChild(option);
    });
    element('robot-log-label').hidden = data.motions.length < 2;
    element('robot-log').onchange = function () { choose(Number(element('robot-log').value)); };
    element('robot-mode').onchange = soon;
    element('robot-play').onclick = function () { play(!playing); };
    element('robot-slider').oninput = function () {
      time = Number(element('robot-slider').value);
      soon();
    };
    choose(0);
  }
  window.furculaRobot = {pose: pose};  // for tests
  window.addEventListener('resize', soon);
  window.addEventListener('beforeprint', draw);
  draw();
})();
