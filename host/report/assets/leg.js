// Draws the strides of #leg-data: a stick figure whose spring has the colour of its torque, on a plain canvas.
(function () {
  'use strict';
  var data = JSON.parse(document.getElementById('leg-data').textContent);
  var strides = data.strides, most = data.most;
  var canvas = document.getElementById('leg-canvas'), paper = canvas.getContext('2d');
  var slider = document.getElementById('leg-slider'), play = document.getElementById('leg-play');
  var shown = document.getElementById('leg-time'), speed = document.getElementById('leg-speed');
  var choice = document.getElementById('leg-choice');
  var stride = strides[0], time = 0, playing = false, last = null;

  // Where the leg is: each row is time, hip x and y, knee x and y, toe x and y, spring's torque, ground's force x and y.
  function pose(t) {
    var rows = stride.rows, period = rows[rows.length - 1][0], turns = Math.floor(t / period);
    var rest = t - turns * period, low = 0, high = rows.length - 1;
    while (high - low > 1) {
      var middle = (low + high) >> 1;
      if (rows[middle][0] <= rest) low = middle; else high = middle;
    }
    var a = rows[low], b = rows[high], width = b[0] - a[0];
    var share = width > 0 ? Math.min(Math.max((rest - a[0]) / width, 0), 1) : 0;
    var out = a.map(function (v, i) { return v + (b[i] - v) * share; });
    [1, 3, 5].forEach(function (i) { out[i] += turns * stride.way; });
    return out;
  }
  // From grey at rest to orange at the largest torque of all strides.
  function colour(torque) {
    var s = most > 0 ? Math.min(Math.abs(torque) / most, 1) : 0;
    return 'rgb(' + Math.round(141 + s * 72) + ',' + Math.round(153 - s * 59) + ',' + Math.round(165 - s * 165) + ')';
  }

  function draw() {
    var size = window.furculaCanvas.fit(canvas);
    if (!size) return;
    var width = size.width, height = size.height;
    var p = pose(time), scale = height / (1.35 * data.reach), base = height - 24;
    // The picture goes with the mean speed, so that the leg swings about its middle.
    var period = stride.rows[stride.rows.length - 1][0];
    var centre = stride.rows[0][1] + stride.way * time / period;
    function at(x, y) { return [width / 2 + (x - centre) * scale, base - y * scale]; }
    function line(points, style, thick) {
      paper.strokeStyle = style;
      paper.lineWidth = thick;
      paper.lineCap = 'round';
      paper.lineJoin = 'round';
      paper.beginPath();
      points.forEach(function (q, i) { if (i) paper.lineTo(q[0], q[1]); else paper.moveTo(q[0], q[1]); });
      paper.stroke();
    }
    function dot(q, radius, style) {
      paper.fillStyle = style;
      paper.beginPath();
      paper.arc(q[0], q[1], radius, 0, 2 * Math.PI);
      paper.fill();
    }
    line([[0, base], [width, base]], '#5b6875', 1.5);
    var mark = 0.2, first = Math.floor((centre - width / 2 / scale) / mark) * mark;
    for (var x = first; x < centre + width / 2 / scale; x += mark)
      line([at(x, 0), [at(x, 0)[0] - 6, base + 8]], '#8d99a5', 1);
    // The way of the hip over the last stride.
    var trail = [];
    for (var i = 0; i <= 40; ++i) {
      var back = pose(Math.max(0, time - period * (40 - i) / 40));
      trail.push(at(back[1], back[2]));
    }
    line(trail, 'rgba(0,114,178,0.35)', 1.5);
    var hip = at(p[1], p[2]), knee = at(p[3], p[4]), toe = at(p[5], p[6]);
    line([hip, knee, toe], '#1f2933', 5);
    // The spring spans the knee, from link to link.
    function between(a, b, s) { return [a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s]; }
    var from = between(knee, hip, 0.45), to = between(knee, toe, 0.45), zigzag = [from];
    var nx = to[1] - from[1], ny = from[0] - to[0], n = Math.hypot(nx, ny) || 1;
    for (var k = 1; k < 9; ++k) {
      var q = between(from, to, k / 9), side = (k % 2 ? 5 : -5) / n;
      zigzag.push([q[0] + nx * side, q[1] + ny * side]);
    }
    zigzag.push(to);
    if (data.spring) line(zigzag, colour(p[7]), 2 + 2 * Math.min(Math.abs(p[7]) / (most || 1), 1));
    dot(knee, 5, '#1f2933');
    dot(toe, 4, '#1f2933');
    dot(hip, 11, '#0072b2');
    if (p[9] > 0) {
      var tip = [toe[0] + 0.35 * p[8], toe[1] - 0.35 * p[9]];
      line([toe, tip], '#0b7a53', 2);
    }
    slider.value = time % period;
    shown.textContent = (time % period).toFixed(3) + ' s';
  }
  function frame(now) {
    if (!playing) return;
    if (last !== null) time += (now - last) / 1000 * Number(speed.value);
    last = now;
    draw();
    requestAnimationFrame(frame);
  }
  function choose(index) {
    stride = strides[index];
    time = 0;
    var rows = stride.rows;
    slider.min = 0;
    slider.max = rows[rows.length - 1][0];
    slider.step = 'any';
    draw();
  }
  strides.forEach(function (s, i) {
    var option = document.createElement('option');
    option.value = i;
    option.textContent = s.name;
    choice.appendChild(option);
  });
  choice.parentNode.hidden = strides.length < 2;
  choice.onchange = function () { choose(Number(choice.value)); };
  slider.oninput = function () { time = Number(slider.value); draw(); };
  play.onclick = function () {
    playing = !playing;
    play.textContent = playing ? 'Pause' : 'Play';
    last = null;
    if (playing) requestAnimationFrame(frame);
  };
  window.onresize = draw;
  window.furculaLeg = {pose: pose};
  choose(0);
})();
