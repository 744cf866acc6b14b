// Where files are dropped or chosen: they go to the server as they are, one after the other.
export default {
  template: `
    <div class="drop" :class="{ over: over, busy: share !== null }"
         @dragover.prevent="over = true" @dragleave="over = false" @drop.prevent="dropped">
      <p class="drop-title">{{ title }}</p>
      <p class="drop-hint">{{ hint }}</p>
      <div class="drop-buttons">
        <button type="button" class="button primary" @click="$refs.files.click()" :disabled="share !== null">{{ button }}</button>
        <button v-if="folderButton" type="button" class="button" @click="$refs.folder.click()" :disabled="share !== null">{{ folderButton }}</button>
      </div>
      <input ref="files" type="file" class="unseen" tabindex="-1" aria-hidden="true" :accept="accept" @change="chosen" />
      <input ref="folder" type="file" class="unseen" tabindex="-1" aria-hidden="true" webkitdirectory multiple @change="chosen" />
      <div v-if="share !== null" class="step" role="status">
        <span class="step-text">{{ what }}</span>
        <progress :value="share" max="1" :aria-label="what"></progress>
      </div>
    </div>`,
  props: { address: String, title: String, hint: String, button: String, folderButton: String, accept: String, kind: String, folderKind: String, mostMegabytes: Number },
  data() {
    return { over: false, share: null, what: "" };
  },
  methods: {
    chosen(event) {
      const files = [...event.target.files];
      const isFolder = event.target === this.$refs.folder;
      event.target.value = "";
      if (files.length) this.send(files, isFolder);
    },
    async dropped(event) {
      this.over = false;
      if (this.share !== null) return;
      const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
      const folder = entries.find((entry) => entry.isDirectory);
      if (folder && this.folderKind) return this.send(await filesOf(folder), true);
      const files = [...event.dataTransfer.files];
      if (files.length > 1 && this.folderKind) return this.send(files, true);
      if (files.length) this.send(files.slice(0, 1), false);
    },
    async send(files, isFolder) {
      const pictures = /\.(jpe?g|png|webp|tiff?)$/i;
      const wanted = isFolder ? files.filter((file) => pictures.test(file.name) && !file.name.startsWith(".")) : files;
      if (!wanted.length) {
        this.$emit("failed", "There are no pictures in this folder. Choose one with JPEG or PNG frames.");
        return;
      }
      // The server refuses it too, but not before some of it was sent.
      const large = wanted.find((file) => file.size > 1e6 * this.mostMegabytes);
      if (large) {
        this.$emit("failed", `${large.name} is larger than ${this.mostMegabytes} MB, which is the most that is taken. Give its path on this machine instead, or start the application with a higher limit.`);
        return;
      }
      wanted.sort((a, b) => a.name.localeCompare(b.name, "en", { numeric: true }));
      const batch = isFolder ? `frames-${Date.now()}` : "";
      let last = null;
      this.share = 0;
      try {
        for (const [number, file] of wanted.entries()) {
          this.what = wanted.length > 1 ? `Sending ${number + 1} of ${wanted.length}` : `Sending ${file.name}`;
          last = await this.put(file, isFolder ? this.folderKind : this.kind, batch, (share) => {
            this.share = (number + share) / wanted.length;
          });
        }
        this.$emit("sent", { file: last, name: isFolder ? `${wanted.length} frames` : wanted[0].name, folder: isFolder });
      } catch (error) {
        this.$emit("failed", error.message);
      } finally {
        this.share = null;
      }
    },
    put(file, kind, batch, tell) {
      return new Promise((resolve, reject) => {
        const request = new XMLHttpRequest();
        const query = new URLSearchParams({ name: file.name, batch });
        request.open("PUT", `${this.address}/${kind}?${query}`);
        request.upload.addEventListener("progress", (event) => event.lengthComputable && tell(event.loaded / event.total));
        request.addEventListener("load", () => {
          let answer = {};
          try {
            answer = JSON.parse(request.responseText);
          } catch {
            // Not from the application: told below.
          }
          if (answer.file) resolve(answer.file);
          else reject(new Error(answer.error ?? `The server refused the file (${request.status}).`));
        });
        request.addEventListener("error", () => reject(new Error("The file was not sent: the application does not answer, or stopped taking it. It may be too large.")));
        request.send(file);
      });
    },
  },
};

async function filesOf(folder) {
  const reader = folder.createReader();
  const found = [];
  for (;;) {
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!some.length) return found;
    for (const entry of some) {
      if (entry.isFile) found.push(await new Promise((resolve, reject) => entry.file(resolve, reject)));
    }
  }
}
