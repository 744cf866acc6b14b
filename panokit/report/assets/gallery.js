// The gallery: which maps are shown, in what order, and how their thumbnails look.

class Gallery {
  constructor(maps, renderer) {
    this.maps = maps;
    this.getRenderer = renderer;
    this.cards = maps.map((map) => byId(map.anchor));
    this.seen = new Set();
    this.queue = Promise.resolve();
    this.draft = 0;
    this.observer = new IntersectionObserver((changes) => this.onSeen(changes), { rootMargin: "200px" });
    this.cards.forEach((card) => this.observer.observe(card));
    for (const id of ["filter-text", "filter-verdict", "filter-category", "sort"]) {
      byId(id)?.addEventListener("input", () => this.arrange());
    }
    for (const id of ["thumbnails", "thumbnail-exposure"]) {
      byId(id).addEventListener("input", () => this.restyle());
    }
    byId("gallery-tools").hidden = false;
    this.arrange();
    this.restyle();
  }

  get shown() {
    return this.arranged;
  }

  arrange() {
    const text = byId("filter-text").value.trim().toLowerCase();
    const verdict = byId("filter-verdict")?.value ?? "";
    const category = byId("filter-category")?.value ?? "";
    const matches = (map) =>
      (!text || `${map.name} ${map.subtitle}`.toLowerCase().includes(text)) &&
      (!verdict || map.verdict === verdict) && (!category || map.category === category);
    this.arranged = this.sorted().filter((i) => matches(this.maps[i]));
    const kept = new Set(this.arranged);
    this.cards.forEach((card, i) => { card.hidden = !kept.has(i); });
    const list = byId("cards");
    // Moving only where the order differs keeps the focus and spares the layout.
    const sequence = this.sorted().map((i) => this.cards[i]);
    if (sequence.some((card, i) => list.children[i] !== card)) list.append(...sequence);
    byId("gallery-count").textContent = kept.size === this.maps.length
      ? `${kept.size} shown` : `${kept.size} of ${this.maps.length} shown`;
  }

  sorted() {
    const [key, direction] = (byId("sort")?.value ?? "").split("|");
    const order = this.maps.map((_, i) => i);
    if (!key) return order;
    const sign = direction === "down" ? -1 : 1;
    const value = (i) => (key === "name" ? this.maps[i].name : this.maps[i].figures[key] ?? null);
    return order.sort((a, b) => sign * compareValues(value(a), value(b), sign) || a - b);
  }

  onSeen(changes) {
    for (const { target, isIntersecting } of changes) {
      const index = this.cards.indexOf(target);
      if (isIntersecting) this.seen.add(index);
      else this.seen.delete(index);
      if (isIntersecting) this.drawLater(index);
    }
  }

  restyle() {
    const choice = byId("thumbnails");
    if (choice.value !== "picture" && !this.getRenderer()) {
      choice.value = "picture";
      choice.disabled = true;
      byId("gallery-count").textContent = "This browser has no WebGL2: thumbnails stay as they are.";
    }
    const style = choice.value;
    const exposure = byId("thumbnail-exposure");
    this.draft += 1;
    this.style = style;
    this.ev = Number(exposure.value);
    byId("thumbnail-exposure-value").textContent = `${formatStops(this.ev)} EV`;
    exposure.setAttribute("aria-valuetext", `${formatStops(this.ev)} EV`);
    byId("thumbnail-exposure-row").hidden = style === "picture" || style === "false";
    for (const card of this.cards) {
      card.querySelector("img").hidden = style !== "picture";
      card.querySelector("canvas").hidden = style === "picture";
    }
    this.seen.forEach((index) => this.drawLater(index));
  }

  // One after the other, and only what is still wanted when its turn comes.
  drawLater(index) {
    const { draft } = this;
    if (this.style === "picture") return;
    const renderer = this.getRenderer();
    const view = {
      ...START,
      mode: this.style === "balls" ? "balls" : "whole",
      falseColor: this.style === "false",
      ev: this.ev,
    };
    this.queue = this.queue.then(async () => {
      const map = this.maps[index];
      const canvas = this.cards[index].querySelector("canvas");
      const drawn = `${this.style} ${this.ev}`;
      if (draft !== this.draft || !this.seen.has(index) || canvas.dataset.drawn === drawn) return;
      try {
        const loaded = await renderer.load(map.layers[0]);
        canvas.width = 2 * canvas.clientWidth || 640;
        canvas.height = canvas.width / 2;
        renderer.draw(canvas, map, view, loaded, null);
        canvas.dataset.drawn = drawn;
      } catch {
        // The viewer tells what is wrong with a map when it is opened.
        canvas.hidden = true;
        this.cards[index].querySelector("img").hidden = false;
      }
    });
  }
}

// Numbers by size, words by the alphabet; what has no value comes last either way.
function compareValues(a, b, sign = 1) {
  if (a === null || b === null) return sign * ((a === null) - (b === null));
  return typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
}

// Tables that say so are sorted by the buttons in their headings.
function makeSortable(table) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      const sign = down ? -1 : 1;
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const value = ({ cells }) => {
        const { sort } = cells[column].dataset;
        return sort === undefined ? cells[column].textContent.trim() : sort === "" ? null : Number(sort);
      };
      const rows = [...table.tBodies[0].rows];
      rows.sort((a, b) => sign * compareValues(value(a), value(b), sign));
      table.tBodies[0].append(...rows);
    });
  });
}
