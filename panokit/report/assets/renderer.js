// One WebGL context draws everything: browsers allow few. It draws on a canvas of its own, and
// the picture is copied to whichever canvas asked for it.

const KEPT_LAYERS = 16;
const PICTURES = ["map", "diffuse", "glossy"];

class Renderer {
  // Throws where there is no WebGL2.
  constructor(palette) {
    this.palette = palette;
    this.canvas = document.createElement("canvas");
    this.layers = new Map();
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.onRestored = () => {};
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.build();
      this.onRestored();
    });
    this.gl = this.canvas.getContext("webgl2", { antialias: false, depth: false });
    if (!this.gl) throw new Error("no WebGL2");
    this.build();
  }

  build() {
    const gl = this.gl;
    this.layers.clear();
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX_SHADER], [gl.FRAGMENT_SHADER, FRAGMENT_SHADER]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.uniforms = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < count; i++) {
      const { name } = gl.getActiveUniform(program, i);
      this.uniforms[name] = gl.getUniformLocation(program, name);
    }
    [...PICTURES, ...PICTURES.map((name) => `${name}_2`), "palette"].forEach((name, unit) =>
      gl.uniform1i(this.uniforms[`u_${name}`], unit));
    gl.activeTexture(gl.TEXTURE6);
    this.bindNew(gl.LINEAR);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, this.palette);
  }

  bindNew(filter) {
    const gl = this.gl;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    return texture;
  }

  // A layer's pictures on the card, decoded once while it is among the last used.
  async load(layer) {
    const known = this.layers.get(layer.block);
    if (known) {
      this.layers.delete(layer.block);
      this.layers.set(layer.block, known);
      return known;
    }
    const pictures = await decodeLayer(layer);
    const again = this.layers.get(layer.block);
    if (again) return again;
    const gl = this.gl;
    const loaded = { textures: {}, map: pictures.map };
    gl.activeTexture(gl.TEXTURE7);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
    for (const name of PICTURES) {
      const { width, height, codes } = pictures[name];
      loaded.textures[name] = this.bindNew(gl.NEAREST);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB16UI, width, height, 0, gl.RGB_INTEGER, gl.UNSIGNED_SHORT, codes);
    }
    this.layers.set(layer.block, loaded);
    for (const [block, old] of this.layers) {
      if (this.layers.size <= KEPT_LAYERS) break;
      Object.values(old.textures).forEach((texture) => gl.deleteTexture(texture));
      this.layers.delete(block);
    }
    return loaded;
  }

  // Draw what `view` sees of an entry's loaded layers, and copy it to the target.
  draw(target, entry, view, first, second) {
    const gl = this.gl;
    const { width, height } = target;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    [first, second ?? first].forEach((loaded, which) =>
      PICTURES.forEach((name, i) => {
        gl.activeTexture(gl.TEXTURE0 + 3 * which + i);
        gl.bindTexture(gl.TEXTURE_2D, loaded.textures[name]);
      }));
    const u = this.uniforms;
    const ev = 2 ** view.ev;
    gl.uniform2f(u.u_size, width, height);
    gl.uniform1i(u.u_mode, MODES.indexOf(view.mode));
    gl.uniform1i(u.u_samples, samplesPerPixel(view, first.map, width, height));
    gl.uniformMatrix3fv(u.u_world_from_view, false, worldFromView(view));
    gl.uniform1f(u.u_yaw, view.yaw);
    gl.uniform1f(u.u_tangent, Math.tan(view.fov / 2));
    gl.uniform1i(u.u_compare, second ? 1 : 0);
    gl.uniform1f(u.u_split, view.split);
    gl.uniform2f(u.u_layer_gains, entry.layers[0].gain, second ? entry.layers[view.compare].gain : 1);
    gl.uniform1f(u.u_exposure, entry.displayGain * ev);
    gl.uniform1f(u.u_ball_exposure, entry.ballGain * ev);
    gl.uniform1i(u.u_false_color, view.falseColor ? 1 : 0);
    gl.uniform3f(u.u_stops, ...STOPS, 1 / (entry.layers[0].median || 1));
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const context = target.getContext("2d");
    context.clearRect(0, 0, width, height);
    context.drawImage(this.canvas, 0, 0);
  }
}

// As many samples along each side of a pixel as there are map pixels in it, so that a small sun
// is neither missed nor flickers.
function samplesPerPixel(view, map, width, height) {
  if (view.mode === "balls") return 3;
  const across = view.mode === "whole"
    ? map.width / width
    : (Math.tan(view.fov / 2) * 2 / Math.min(width, height)) / (2 * Math.PI / map.width);
  return Math.max(1, Math.min(4, Math.ceil(across)));
}
