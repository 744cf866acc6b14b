// Pointer, keys and controls of the viewer.

const KEY_TURN = 5 * DEGREE;
const KEY_ZOOM = 1.15;
const WHEEL_ZOOM = 0.0012;

function listenToPointer(viewer) {
  const { canvas } = viewer;
  const held = new Map();
  let pinch = 0;
  const shares = (event) => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height, box];
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, event);
    pinch = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = held.get(event.pointerId);
    const [u, v, box] = shares(event);
    if (!before) {
      if (viewer.loaded && viewer.view.mode !== "balls") {
        byId("readout").textContent = viewer.tell(directionAt(viewer.view, u, v, box.width / box.height));
      }
      return;
    }
    held.set(event.pointerId, event);
    if (held.size === 2) {
      const [a, b] = [...held.values()];
      const apart = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (pinch) viewer.change(zoomed(viewer.view, pinch / apart));
      pinch = apart;
      return;
    }
    const side = Math.min(box.width, box.height);
    viewer.change(turned(viewer.view, (event.clientX - before.clientX) / side, (event.clientY - before.clientY) / side));
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => held.delete(event.pointerId));
  }
  canvas.addEventListener("pointerleave", () => { byId("readout").textContent = ""; });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    viewer.change(zoomed(viewer.view, Math.exp(event.deltaY * WHEEL_ZOOM)));
  }, { passive: false });

  const line = byId("split-line");
  line.addEventListener("pointerdown", (event) => line.setPointerCapture(event.pointerId));
  line.addEventListener("pointermove", (event) => {
    if (!line.hasPointerCapture(event.pointerId)) return;
    viewer.change({ split: Math.max(0, Math.min(1, shares(event)[0])) });
  });
}

function listenToKeys(viewer) {
  const turn = (yaw, pitch) => {
    const { view } = viewer;
    const limit = Math.PI / 2;
    viewer.change({ yaw: wrapped(view.yaw + yaw), pitch: Math.max(-limit, Math.min(limit, view.pitch + pitch)) });
  };
  const brighter = (by) => viewer.change({ ev: clampEv(viewer.view.ev + by) });
  // What the arrows do unless a control has the focus that has a use for them itself.
  const arrows = {
    ArrowLeft: () => turn(-KEY_TURN, 0),
    ArrowRight: () => turn(KEY_TURN, 0),
    ArrowUp: () => turn(0, KEY_TURN),
    ArrowDown: () => turn(0, -KEY_TURN),
    Home: () => viewer.change({ ...START, compare: viewer.view.compare }),
  };
  // What letters do wherever the focus is.
  const anywhere = {
    "+": () => viewer.change(zoomed(viewer.view, 1 / KEY_ZOOM)),
    "=": () => viewer.change(zoomed(viewer.view, 1 / KEY_ZOOM)),
    "-": () => viewer.change(zoomed(viewer.view, KEY_ZOOM)),
    "]": () => brighter(1),
    "[": () => brighter(-1),
    f: () => viewer.change({ falseColor: !viewer.view.falseColor }),
    c: () => viewer.change({ compare: (viewer.view.compare + 1) % viewer.entry.layers.length }),
    1: () => viewer.change({ mode: "look" }),
    2: () => viewer.change({ mode: "whole" }),
    3: () => viewer.change({ mode: "balls" }),
    n: () => viewer.step(1),
    p: () => viewer.step(-1),
  };
  // On the document: a click beside the controls takes the focus out of the dialog.
  document.addEventListener("keydown", (event) => {
    if (!viewer.dialog.open || event.ctrlKey || event.metaKey || event.altKey) return;
    if (!viewer.loaded && !"np".includes(event.key)) return;
    const { target } = event;
    const turns = target === viewer.canvas || target === viewer.dialog || target === document.body;
    const action = (turns && arrows[event.key]) || anywhere[event.key];
    if (!action || target.tagName === "SELECT") return;
    event.preventDefault();
    action();
  });
}

function clampEv(ev) {
  const { min, max } = byId("exposure");
  return Math.max(Number(min), Math.min(Number(max), ev));
}

function listenToControls(viewer) {
  const on = (id, kind, change) => byId(id).addEventListener(kind, (event) => viewer.change(change(event.target)));
  for (const mode of MODES) on(`mode-${mode}`, "change", () => ({ mode }));
  on("exposure", "input", ({ value }) => ({ ev: Number(value) }));
  on("zoom", "input", ({ value }) => ({ fov: -Number(value) * DEGREE }));
  on("false-color", "change", ({ checked }) => ({ falseColor: checked }));
  on("compare", "change", ({ value }) => ({ compare: Number(value) }));
  on("split", "input", ({ value }) => ({ split: Number(value) / 100 }));
  byId("reset").addEventListener("click", () => viewer.change({ ...START }));
  byId("viewer-previous").addEventListener("click", () => viewer.step(-1));
  byId("viewer-next").addEventListener("click", () => viewer.step(1));
  byId("viewer-close").addEventListener("click", () => viewer.dialog.close());
}
