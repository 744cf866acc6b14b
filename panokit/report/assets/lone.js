// One map that is open from the start, in a frame of another page.

function startAlone() {
  document.documentElement.classList.add("scripted");
  let made;
  const renderer = () => {
    if (made === undefined) {
      try {
        made = typeof DecompressionStream === "undefined" ? null : new Renderer(PALETTE);
        if (made) made.onRestored = () => viewer.open(0);
      } catch {
        made = null;
      }
    }
    return made;
  };
  const viewer = new Viewer(MAPS, renderer);
  // The page around the frame has the keyboard until its reader turns to the map.
  viewer.dialog.showModal = () => { viewer.dialog.open = true; };
  const focus = viewer.canvas.focus;
  viewer.canvas.focus = () => {};
  viewer.canvas.removeAttribute("autofocus");
  viewer.open(0).finally(() => { viewer.canvas.focus = focus; });
}

startAlone();
