// Starts the page. Everything a reader needs stands in it already; this makes it move.

function whenWhole() {
  return document.readyState === "loading"
    ? new Promise((resolve) => { document.addEventListener("DOMContentLoaded", resolve, { once: true }); })
    : Promise.resolve();
}

// The one renderer, made when it is first needed: most of the time of opening the page would
// else be the graphics card's. Null where there is none to be had.
function rendererOnDemand() {
  let made;
  const get = () => {
    if (made === undefined) {
      try {
        made = typeof DecompressionStream === "undefined" ? null : new Renderer(PALETTE);
        if (made) made.onRestored = () => get.onRestored();
      } catch {
        made = null;
      }
    }
    return made;
  };
  get.onRestored = () => {};
  return get;
}

function start() {
  document.documentElement.classList.add("scripted");
  document.querySelectorAll("table.sortable").forEach(makeSortable);
  if (!MAPS.length) return;
  const renderer = rendererOnDemand();
  const viewer = new Viewer(MAPS, renderer);
  const gallery = new Gallery(MAPS, renderer);
  viewer.order = () => gallery.shown;
  renderer.onRestored = () => {
    if (viewer.dialog.open) viewer.open(viewer.index);
  };
  const open = async (index) => {
    await whenWhole();
    viewer.open(index);
  };
  gallery.cards.forEach((card, index) => {
    const button = card.querySelector("button");
    button.disabled = false;
    button.addEventListener("click", () => open(index));
  });
  // A link to a map opens it, so that a map can be pointed to from outside.
  const openNamed = () => {
    const index = MAPS.findIndex((map) => `#${map.anchor}` === location.hash);
    if (index >= 0) open(index);
  };
  addEventListener("hashchange", openNamed);
  document.addEventListener("click", (event) => {
    const link = event.target.closest?.("a.map-link");
    if (link && link.hash === location.hash) openNamed();
  });
  openNamed();
}

start();
