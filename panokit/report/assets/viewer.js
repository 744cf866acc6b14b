// The dialog in which one map is looked at: what is drawn, and the words beside it.

const STATUS_DELAY_MS = 400;

class Viewer {
  constructor(maps, renderer) {
    this.maps = maps;
    this.getRenderer = renderer;
    this.view = { ...START };
    this.order = () => maps.map((_, i) => i);
    this.dialog = byId("viewer");
    this.canvas = byId("view");
    this.stage = byId("stage");
    this.loaded = null;
    this.opened = 0;
    this.pending = false;
    listenToPointer(this);
    listenToKeys(this);
    listenToControls(this);
    new ResizeObserver(() => this.redraw()).observe(this.stage);
    this.drawLegend();
  }

  get entry() {
    return this.maps[this.index];
  }

  async open(index) {
    this.index = index;
    const { entry } = this;
    const ticket = ++this.opened;
    if (!entry.layers[this.view.compare]) this.view = { ...this.view, compare: 0 };
    this.loaded = null;
    this.describe();
    if (!this.dialog.open) this.dialog.showModal();
    this.renderer = this.getRenderer();
    if (!this.renderer) {
      this.fall("This browser has no WebGL2, so you cannot look around in the map; its figures are beside it.");
      return;
    }
    try {
      const first = await this.renderer.load(entry.layers[0]);
      if (ticket !== this.opened) return;
      this.loaded = { first, second: null };
      await this.loadSecond(ticket);
      // Opened by a link, the browser takes the focus to the link's place.
      if (!this.dialog.contains(document.activeElement)) this.canvas.focus();
    } catch (error) {
      if (ticket === this.opened) this.fall(`The map cannot be shown: ${error.message}.`);
      return;
    }
    this.redraw();
    this.say();
  }

  async loadSecond(ticket = this.opened) {
    const layer = this.view.compare ? this.entry.layers[this.view.compare] : null;
    const second = layer ? await this.renderer.load(layer) : null;
    if (ticket === this.opened && this.loaded) this.loaded.second = second;
  }

  step(by) {
    const order = this.order();
    const place = order.indexOf(this.index);
    if (order.length) this.open(order[(place + by + order.length) % order.length]);
  }

  async change(changes) {
    const compare = this.view.compare;
    this.view = { ...this.view, ...changes };
    if (this.view.compare !== compare && this.loaded) await this.loadSecond();
    this.redraw();
    this.say();
  }

  // Any number of changes between two frames are one picture.
  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.showControls();
      if (!this.loaded || !this.dialog.open) return;
      this.fit();
      const { first, second } = this.loaded;
      this.renderer.draw(this.canvas, this.entry, this.view, first, this.view.compare ? second : null);
      this.canvas.dataset.drawn = String(Number(this.canvas.dataset.drawn ?? 0) + 1);
    });
  }

  fit() {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }

  // Without a picture that can be turned: the flat one, and why.
  fall(why) {
    byId("stage-message").textContent = why;
    byId("stage-message").hidden = false;
    const flat = byId("stage-picture");
    flat.src = this.thumbnail().src;
    flat.alt = this.thumbnail().alt;
    flat.hidden = false;
    this.stage.classList.add("fallen");
    byId("controls").hidden = true;
    // The picture that had the focus is gone; keys must still reach the dialog.
    if (!this.dialog.contains(document.activeElement) || document.activeElement === this.canvas) byId("viewer-side").focus();
  }

  thumbnail() {
    return byId(this.entry.anchor).querySelector("img");
  }

  describe() {
    const { entry } = this;
    const card = byId(entry.anchor);
    byId("viewer-title").replaceChildren(...card.querySelector(".name").cloneNode(true).childNodes);
    byId("viewer-subtitle").textContent = entry.subtitle;
    byId("viewer-summary").textContent = entry.summary;
    byId("viewer-summary").hidden = !entry.summary;
    byId("viewer-badge").replaceChildren(...[...card.querySelectorAll(".about .badge")].map((badge) => badge.cloneNode(true)));
    const facts = card.querySelector(".facts-body");
    byId("viewer-facts").replaceChildren(...(facts ? [...facts.cloneNode(true).children] : []));
    byId("viewer-facts").scrollTop = 0;
    const order = this.order();
    const place = order.indexOf(this.index) + 1;
    byId("viewer-place").textContent = place ? `${place} of ${order.length}` : "";
    const compare = byId("compare");
    const others = entry.layers.slice(1).map((layer, i) => new Option(layer.label, String(i + 1)));
    compare.replaceChildren(new Option("nothing", "0"), ...others);
    byId("compare-row").hidden = !others.length;
    this.canvas.setAttribute("aria-label", `${entry.name}, view of the light map`);
    byId("stage-message").hidden = true;
    byId("controls").hidden = false;
    byId("stage-picture").hidden = true;
    this.stage.classList.remove("fallen");
    this.showControls();
  }

  showControls() {
    const { view, entry } = this;
    if (!entry) return;
    for (const mode of MODES) byId(`mode-${mode}`).checked = view.mode === mode;
    byId("exposure").value = String(view.ev);
    byId("exposure").setAttribute("aria-valuetext", `${formatStops(view.ev)} EV`);
    byId("exposure-value").textContent = `${formatStops(view.ev)} EV`;
    byId("exposure").disabled = view.falseColor;
    const degrees = Math.round(view.fov / DEGREE);
    byId("zoom").value = String(-degrees);
    byId("zoom").setAttribute("aria-valuetext", `${degrees} degrees of view`);
    byId("zoom-value").textContent = `${degrees}°`;
    byId("zoom-row").hidden = view.mode !== "look";
    byId("false-color").checked = view.falseColor;
    byId("legend").hidden = !view.falseColor;
    byId("compare").value = String(view.compare);
    const split = view.compare > 0 && view.mode !== "balls";
    byId("split-row").hidden = !split;
    byId("split").value = String(Math.round(100 * view.split));
    byId("split").setAttribute("aria-valuetext", `${Math.round(100 * view.split)} percent`);
    byId("split-line").hidden = !split;
    byId("split-line").style.left = `${100 * view.split}%`;
    byId("label-before").hidden = byId("label-after").hidden = !view.compare;
    byId("label-after").textContent = entry.layers[0].label;
    byId("label-before").textContent = entry.layers[view.compare].label;
    byId("ball-labels").hidden = view.mode !== "balls";
    this.stage.classList.toggle("balls", view.mode === "balls");
    this.stage.classList.toggle("whole", view.mode === "whole");
    this.stage.classList.toggle("comparing", view.compare > 0);
  }

  drawLegend() {
    const context = byId("legend-bar").getContext("2d");
    const image = context.createImageData(256, 1);
    for (let i = 0; i < 256; i++) image.data.set([...PALETTE.subarray(3 * i, 3 * i + 3), 255], 4 * i);
    context.putImageData(image, 0, 0);
  }

  // What light comes from a direction, in words.
  tell(direction) {
    const { azimuth, elevation } = anglesOf(direction);
    const layer = this.entry.layers[0];
    const light = luminanceOf(radianceAt(this.loaded.first.map, direction)) * layer.gain;
    const stops = light > 0 && layer.median > 0 ? `, ${formatStops(Math.log2(light / layer.median))} stops from the median` : "";
    return `Azimuth ${Math.round(azimuth)}°, elevation ${Math.round(elevation)}°: luminance ${formatFigure(light)} ${this.entry.unit}${stops}`;
  }

  // The middle of the view, for those who hear it: once, when it has come to rest.
  say() {
    clearTimeout(this.saying);
    this.saying = setTimeout(() => {
      if (!this.loaded) return;
      const { canvas, view } = this;
      const middle = directionAt(view, 0.5, 0.5, canvas.width / canvas.height);
      const words = view.mode === "balls"
        ? `Balls seen from azimuth ${Math.round(wrapped(view.yaw + Math.PI) / DEGREE)}°`
        : this.tell(middle);
      byId("view-status").textContent = words;
    }, STATUS_DELAY_MS);
  }
}
