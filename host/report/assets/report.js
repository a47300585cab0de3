// Draws the traces of #trace-data: the chosen recording and channel, and measured minus simulated below on the same
// time axis.
(function () {
  'use strict';
  var data = JSON.parse(document.getElementById('trace-data').textContent);
  var element = function (id) { return document.getElementById(id); };
  var LOOK = {
    'measured': {color: '#1f2933', strokeWidth: 2.2},
    'as given': {color: '#8d99a5', strokeWidth: 1.5, strokePattern: [5, 4]},
    're-fitted': {color: '#d55e00', strokeWidth: 1.5},
    'extended': {color: '#0072b2', strokeWidth: 1.7},
    'identified': {color: '#0072b2', strokeWidth: 1.7}
  };
  // Errors are small: shown in thousandths of the channel's unit.
  var THOUSANDTH = {'m': 'mm', 'm/s': 'mm/s', 'rad': 'mrad', 'rad/s': 'mrad/s'};
  // Pixels on paper: the width between the margins of A4 and of Letter, the heights of the two plots.
  var PAPER = {width: 660, heights: [270, 170]};
  var upper = null, lower = null, current = null, moving = false, visible = {};

  function unique(list) { return list.filter(function (v, i) { return list.indexOf(v) === i; }); }
  function capital(s) { s = s.replace(/_/g, ' '); return s.charAt(0).toUpperCase() + s.slice(1); }
  function escaped(s) { return s.replace(/[&<>"']/g, function (c) { return '&#' + c.charCodeAt(0) + ';'; }); }

  function fill(select, texts) {
    select.textContent = '';
    texts.forEach(function (text, i) {
      var option = document.createElement('option');
      option.value = i;
      option.textContent = text;
      select.appendChild(option);
    });
  }

  // Rows for dygraphs. A row of nulls between two windows interrupts the lines there.
  function rows(series, columns) {
    var out = [], next = 1;
    for (var i = 0; i < series.time.length; ++i) {
      if (i === series.starts[next]) {
        out.push([series.time[i]].concat(columns.map(function () { return null; })));
        ++next;
      }
      out.push([series.time[i]].concat(columns.map(function (c) { return c[i]; })));
    }
    return out;
  }

  function windowRange(series, k) {
    var begin = series.starts[k];
    var end = (k + 1 < series.starts.length ? series.starts[k + 1] : series.time.length) - 1;
    return [series.time[begin], series.time[end]];
  }

  function together(other) {
    return function (graph, initial) {
      var target = other();
      if (moving || initial || !target) return;
      moving = true;
      target.updateOptions({dateWindow: graph.xAxisRange()});
      moving = false;
    };
  }

  function options(labels, ylabel, extra) {
    var look = {};
    labels.forEach(function (l) { look[l] = LOOK[l] || {color: '#0b7a53'}; });
    var all = {
      labels: ['time'].concat(labels), series: look, legend: 'never', ylabel: escaped(ylabel), axisLineColor: '#9aa5b1',
      gridLineColor: '#e6ebf0', connectSeparatedPoints: false, highlightCircleSize: 3, yAxisLabelWidth: 52, xRangePad: 4,
      labelsKMB: false, digitsAfterDecimal: 4, animatedZooms: false,
      pixelRatio: Math.max(2, window.devicePixelRatio || 1),  // sharp on paper too
      visibility: labels.map(function (l) { return visible[l] !== false; })
    };
    Object.keys(extra).forEach(function (k) { all[k] = extra[k]; });
    return all;
  }

  function legend(row) {
    var box = element('trace-legend');
    box.textContent = '';
    current.labels.forEach(function (label, i) {
      var button = document.createElement('button');
      var look = LOOK[label] || {color: '#0b7a53'};
      button.type = 'button';
      button.className = visible[label] === false ? 'hidden' : '';
      var line = document.createElement('i');
      line.style.borderColor = look.color;
      if (look.strokePattern) line.className = 'dashed';
      button.appendChild(line);
      var value = row === undefined ? null : current.upperRows[row][i + 1];
      button.appendChild(document.createTextNode(
          label + (value === null ? '' : ' ' + value.toPrecision(5) + ' ' + current.series.unit)));
      button.onclick = function () { visible[label] = visible[label] === false; show(true); };
      box.appendChild(button);
    });
  }

  function show(keepRange) {
    var log = current.logs[element('pick-log').value], channel = current.channels[element('pick-channel').value];
    var series = data.series.filter(function (s) { return s.log === log && s.channel === channel; })[0];
    if (!series) return;
    var range = keepRange && upper ? upper.xAxisRange() : null;
    var present = data.labels.map(function (_, i) { return series.values[i].length > 0; });
    var labels = data.labels.filter(function (_, i) { return present[i]; });
    var columns = series.values.filter(function (_, i) { return present[i]; });
    var unit = THOUSANDTH[series.unit], factor = unit ? 1e3 : 1;
    var errors = columns.slice(1).map(function (c) {
      return c.map(function (v, i) { return v === null || columns[0][i] === null ? null : factor * (columns[0][i] - v); });
    });
    current.series = series;
    current.labels = labels;
    current.upperRows = rows(series, columns);
    if (upper) upper.destroy();
    if (lower) lower.destroy();
    upper = lower = null;
    upper = new Dygraph(element('trace-plot'), current.upperRows,
        options(labels, capital(series.channel) + ' (' + series.unit + ')', {
          drawCallback: together(function () { return lower; }),
          highlightCallback: function (event, x, points, row) { legend(row); },
          unhighlightCallback: function () { legend(); }
        }));
    lower = errors.length === 0 ? null : new Dygraph(element('error-plot'), rows(series, errors),
        options(labels.slice(1), 'Error (' + (unit || series.unit) + ')', {
          xlabel: series.one_after_the_other ? 'time, windows one after the other (s)' : 'time (s)',
          drawCallback: together(function () { return upper; })
        }));
    if (range) upper.updateOptions({dateWindow: range});
    if (!keepRange) {
      fill(element('pick-window'), ['all ' + series.starts.length].concat(series.starts.map(function (_, k) {
        var r = windowRange(series, k);
        return (k + 1) + ': ' + r[0].toFixed(2) + ' to ' + r[1].toFixed(2) + ' s';
      })));
    }
    element('trace-caption').textContent = log;
    legend();
  }

  function showWindow(step) {
    var pick = element('pick-window');
    var k = Math.min(Math.max(Number(pick.value) + step, 0), current.series.starts.length);
    pick.value = k;
    if (k === 0) upper.resetZoom();
    else upper.updateOptions({dateWindow: windowRange(current.series, k - 1)});
  }

  // Canvases keep the pixels they were drawn with, so they are drawn anew for the paper.
  function resize(paper) {
    [upper, lower].forEach(function (graph, i) {
      if (!graph) return;
      var div = element(i ? 'error-plot' : 'trace-plot');
      div.style.width = paper ? paper.width + 'px' : '';
      div.style.height = paper ? paper.heights[i] + 'px' : '';
      graph.resize();
    });
  }

  current = {
    logs: unique(data.series.map(function (s) { return s.log; })),
    channels: unique(data.series.map(function (s) { return s.channel; }))
  };
  fill(element('pick-log'), current.logs);
  fill(element('pick-channel'), current.channels.map(capital));
  element('pick-log-label').hidden = current.logs.length < 2;
  element('pick-channel-label').hidden = current.channels.length < 2;
  element('pick-log').onchange = element('pick-channel').onchange = function () { show(false); };
  element('pick-window').onchange = function () { showWindow(0); };
  element('window-before').onclick = function () { showWindow(-1); };
  element('window-after').onclick = function () { showWindow(1); };
  window.addEventListener('beforeprint', function () { resize(PAPER); });
  window.addEventListener('afterprint', function () { resize(null); });
  show(false);
})();
