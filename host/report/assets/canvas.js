// What the pages' canvases share: as sharp as the screen, and a camera that looks at a point from a turn and a tilt.
window.furculaCanvas = (function () {
  'use strict';
  return {
    // Fits the canvas to its place on the page and clears it: its size in the page's pixels, or null where it has none.
    fit: function (canvas) {
      var width = canvas.clientWidth, height = canvas.clientHeight, sharp = Math.max(window.devicePixelRatio || 1, 1);
      if (!width || !height) return null;
      if (canvas.width !== Math.round(width * sharp) || canvas.height !== Math.round(height * sharp)) {
        canvas.width = Math.round(width * sharp);
        canvas.height = Math.round(height * sharp);
      }
      var paper = canvas.getContext('2d');
      paper.setTransform(sharp, 0, 0, sharp, 0, 0);
      paper.clearRect(0, 0, width, height);
      return {width: width, height: height};
    },
    // A function from a point in space to [right, down, depth], z up, `away` from the centre, `focal` pixels long.
    camera: function (view, centre, away, focal, size) {
      var st = Math.sin(view.turn), ct = Math.cos(view.turn), si = Math.sin(view.tilt), co = Math.cos(view.tilt);
      return function (p) {
        var x = p[0] - centre[0], y = p[1] - centre[1], z = p[2] - centre[2];
        var right = ct * x + st * y, into = -st * x + ct * y, up = co * z + si * into, depth = co * into - si * z;
        var k = focal / Math.max(away + depth, 0.1 * away);
        return [size.width / 2 + right * k, size.height / 2 - up * k, depth];
      };
    }
  };
})();
