// Where the viewer looks, and which way each of its pixels looks. Angles are radians; yaw grows
// to the right from the map's center, pitch upward.

const MODES = ["look", "whole", "balls"];
const STOPS = [-6, 14];
const DEGREE = Math.PI / 180;
const FOV_RANGE = [25 * DEGREE, 120 * DEGREE];
const START = { mode: "look", yaw: 0, pitch: 0, fov: 80 * DEGREE, ev: 0, falseColor: false, compare: 0, split: 0.5 };

// Column by column: the world directions of the view's right, up and back.
function worldFromView({ yaw, pitch }) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return [cy, 0, sy, sp * -sy, cp, sp * cy, cp * -sy, -sp, cp * cy];
}

// The world direction of a place in the picture, given as shares from its top left.
function directionAt(view, u, v, aspect) {
  if (view.mode === "whole") {
    const azimuth = (u - 0.5) * 2 * Math.PI + view.yaw;
    const elevation = (0.5 - v) * Math.PI;
    const level = Math.cos(elevation);
    return [level * Math.sin(azimuth), Math.sin(elevation), -level * Math.cos(azimuth)];
  }
  const scale = Math.tan(view.fov / 2);
  const wide = aspect > 1 ? aspect : 1;
  const high = aspect > 1 ? 1 : 1 / aspect;
  const [x, y] = [(2 * u - 1) * wide * scale, (1 - 2 * v) * high * scale];
  const m = worldFromView(view);
  const d = [0, 1, 2].map((i) => m[i] * x + m[3 + i] * y - m[6 + i]);
  const length = Math.hypot(...d);
  return d.map((value) => value / length);
}

// The view turned by a drag of so many shares of the picture's shorter side: what is held stays
// under the pointer.
function turned(view, right, down) {
  const perShare = view.mode === "look" ? 2 * Math.tan(view.fov / 2) : Math.PI;
  const yaw = wrapped(view.yaw - right * perShare);
  const pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, view.pitch + down * perShare));
  return { ...view, yaw, pitch };
}

function wrapped(angle) {
  const turn = 2 * Math.PI;
  return ((angle + Math.PI) % turn + turn) % turn - Math.PI;
}

function zoomed(view, factor) {
  return { ...view, fov: Math.max(FOV_RANGE[0], Math.min(FOV_RANGE[1], view.fov * factor)) };
}

function anglesOf([x, y, z]) {
  return { azimuth: Math.atan2(x, -z) / DEGREE, elevation: Math.asin(Math.max(-1, Math.min(1, y))) / DEGREE };
}

function formatFigure(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e6) {
    return size >= 100 ? Math.round(value).toLocaleString("en") : String(Number(value.toPrecision(3)));
  }
  return value.toExponential(1).replace("e+", "e");
}

function formatStops(stops) {
  const rounded = Math.round(stops * 10) / 10;
  return `${rounded > 0 ? "+" : rounded < 0 ? "−" : ""}${Math.abs(rounded)}`;
}
