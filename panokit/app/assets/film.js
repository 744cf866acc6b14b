// Frames of a video as pictures, with what is selected in them. They are played and scrubbed here;
// clicks and strokes go to the server in pixels of the frame.

const AHEAD = 8;
const KEPT = 90;
const CURSOR_STEP = 0.02;

export default {
  template: `
    <div class="film">
      <div ref="stage" class="film-stage" :class="mode" tabindex="0" role="application" :aria-label="label" :aria-describedby="hintId"
           :style="{ aspectRatio: width + ' / ' + height }"
           @pointerdown="down" @pointermove="moved" @pointerup="up" @pointercancel="stroke = null" @keydown="key" @blur="cursor = null">
        <img :src="shown" :alt="label + ', frame ' + (frame + 1) + ' of ' + count" draggable="false">
        <img v-if="mask && maskFrame === frame" class="film-mask" :src="mask" alt="" draggable="false">
        <svg :viewBox="'0 0 ' + width + ' ' + height" preserveAspectRatio="none" aria-hidden="true">
          <rect v-if="box" class="film-box" :class="box[4]" :x="box[0]" :y="box[1]" :width="box[2]" :height="box[3]" />
          <polyline v-if="stroke" class="film-stroke" :class="mode" :points="strokePoints" :stroke-width="2 * radius" />
          <g v-if="cursor" class="film-cursor" :transform="'translate(' + cursor[0] + ' ' + cursor[1] + ')'">
            <path :d="cross" class="under" /><path :d="cross" />
          </g>
        </svg>
      </div>
      <div v-if="count > 1" class="film-bar">
        <button type="button" class="button" @click="toggle" :aria-label="playing ? 'Pause' : 'Play'">{{ playing ? '❚❚' : '▶' }}</button>
        <input type="range" min="0" :max="count - 1" step="1" :value="frame" @input="pause(); show(Number($event.target.value))"
               aria-label="Frame" :aria-valuetext="'frame ' + (frame + 1) + ' of ' + count">
        <output>{{ frame + 1 }} / {{ count }}</output>
      </div>
      <p class="unseen" role="status">{{ told }}</p>
    </div>`,
  props: {
    address: String, count: Number, fps: Number, width: Number, height: Number, start: Number, label: String, hintId: String,
    mode: String, mask: String, maskFrame: Number, boxes: Object, brush: Number,
  },
  data() {
    return { frame: this.start ?? 0, shown: `${this.address}/${this.start ?? 0}`, playing: false, stroke: null, cursor: null, told: "" };
  },
  computed: {
    box() {
      return this.boxes?.[this.frame] ?? null;
    },
    radius() {
      return (this.brush ?? 0.02) * this.width;
    },
    strokePoints() {
      const points = this.stroke.length === 1 ? [this.stroke[0], this.stroke[0]] : this.stroke;
      return points.map((point) => point.join(",")).join(" ");
    },
    cross() {
      const r = this.width / 40;
      return `M${-r} 0H${r}M0 ${-r}V${r}`;
    },
  },
  watch: {
    address() {
      this.pause();
      this.pictures = new Map();
      this.frame = this.start ?? 0;
      this.shown = `${this.address}/${this.frame}`;
    },
  },
  created() {
    this.pictures = new Map();
    this.wanted = this.frame;
  },
  beforeUnmount() {
    this.playing = false;
  },
  methods: {
    load(number) {
      const known = this.pictures.get(number);
      if (known) return known;
      const picture = new Image();
      picture.src = `${this.address}/${number}`;
      const ready = picture.decode().then(() => picture.src);
      ready.catch(() => this.pictures.delete(number));
      this.pictures.set(number, ready);
      if (this.pictures.size > KEPT) this.pictures.delete(this.pictures.keys().next().value);
      return ready;
    },
    // The frame asked for last is what is shown, in whatever order pictures come.
    async show(number) {
      const frame = Math.max(0, Math.min(this.count - 1, number));
      this.wanted = frame;
      try {
        const source = await this.load(frame);
        if (this.wanted !== frame) return false;
        this.shown = source;
        this.frame = frame;
        return true;
      } catch {
        if (this.wanted === frame) this.told = `Frame ${frame + 1} cannot be shown.`;
        return false;
      }
    },
    toggle() {
      if (this.playing) this.pause();
      else this.play();
    },
    pause() {
      this.playing = false;
    },
    async play() {
      const turn = (this.turn = (this.turn ?? 0) + 1);
      this.playing = true;
      if (this.frame >= this.count - 1) await this.show(0);
      const period = 1000 / (this.fps > 0 ? Math.min(this.fps, 60) : 25);
      let due = performance.now();
      while (this.playing && turn === this.turn && this.frame < this.count - 1) {
        const next = this.frame + 1;
        for (let i = next; i < Math.min(next + AHEAD, this.count); i++) this.load(i).catch(() => {});
        due = Math.max(due + period, performance.now());
        if (!(await this.show(next))) break;
        await new Promise((resolve) => setTimeout(resolve, Math.max(0, due - performance.now())));
      }
      if (turn === this.turn) this.playing = false;
    },
    place(event) {
      const box = this.$refs.stage.getBoundingClientRect();
      const at = (value, start, length, size) => Math.max(0, Math.min(size - 0.01, ((value - start) / length) * size));
      return [at(event.clientX, box.left, box.width, this.width), at(event.clientY, box.top, box.height, this.height)]
        .map((value) => Math.round(value * 100) / 100);
    },
    down(event) {
      if (event.button !== 0 || this.mode === "look") return;
      this.cursor = null;
      this.pause();
      if (this.mode === "pick") return;
      event.preventDefault();
      this.$refs.stage.setPointerCapture(event.pointerId);
      this.stroke = [this.place(event)];
    },
    moved(event) {
      if (this.stroke) this.stroke.push(this.place(event));
    },
    up(event) {
      if (this.mode === "pick") this.pick(this.place(event));
      else if (this.stroke) this.draw(this.stroke);
      this.stroke = null;
    },
    pick([x, y]) {
      this.pause();
      this.$emit("pick", { x, y, frame: this.frame });
    },
    draw(points) {
      this.$emit("stroke", { points, radius: this.radius, adds: this.mode === "add", frame: this.frame });
    },
    // All that a pointer does: a cursor that arrows move, and Enter to press with it.
    key(event) {
      const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      const step = CURSOR_STEP * this.width * (event.shiftKey ? 0.25 : 1);
      if (moves[event.key] && this.mode !== "look") {
        const [x, y] = this.cursor ?? [this.width / 2, this.height / 2];
        const [right, down] = moves[event.key];
        this.cursor = [Math.max(0, Math.min(this.width - 1, x + right * step)), Math.max(0, Math.min(this.height - 1, y + down * step))];
        this.told = `Cursor at ${Math.round((100 * this.cursor[0]) / this.width)} percent across, ${Math.round((100 * this.cursor[1]) / this.height)} percent down`;
      } else if (event.key === "Enter" && this.cursor) {
        if (this.mode === "pick") this.pick(this.cursor);
        else if (this.mode !== "look") this.draw([this.cursor]);
      } else if (event.key === " " && this.count > 1) {
        this.toggle();
      } else if (event.key === "," || event.key === ".") {
        this.pause();
        this.show(this.frame + (event.key === "," ? -1 : 1));
      } else {
        return;
      }
      event.preventDefault();
    },
  },
};
