// Radiance from the page's text: base64, deflate, predicted bfloat16 codes (see bfloat.py).
// A code is the upper half of a float32; every layer of the viewer is an array of such codes.

const floatView = new Float32Array(1);
const bitsView = new Uint32Array(floatView.buffer);

function floatOfCode(code) {
  bitsView[0] = code << 16;
  return floatView[0];
}

function codeOfFloat(value) {
  floatView[0] = value;
  const bits = bitsView[0];
  return (bits + 0x7fff + ((bits >>> 16) & 1)) >>> 16;
}

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// One plane: differences to the left (in the first column: from above) summed up again.
function unpredict(bytes, start, high, width, height) {
  const plane = new Uint16Array(width * height);
  let first = 0;
  for (let y = 0, i = 0; y < height; y++) {
    let value = 0;
    for (let x = 0; x < width; x++, i++) {
      const zigzag = bytes[start + i] | (bytes[high + start + i] << 8);
      const step = (zigzag >>> 1) ^ -(zigzag & 1);
      value = (x === 0 ? (first += step) : value + step) & 0xffff;
      plane[i] = value;
    }
  }
  return plane;
}

function codesOfPlanes(bytes, width, height) {
  const count = width * height;
  const [green, red, blue] = [0, 1, 2].map((k) =>
    unpredict(bytes, k * count, 3 * count, width, height));
  const codes = new Uint16Array(3 * count);
  for (let i = 0; i < count; i++) {
    codes[3 * i] = red[i] + green[i];
    codes[3 * i + 1] = green[i];
    codes[3 * i + 2] = blue[i] + green[i];
  }
  return codes;
}

async function decodeRadiance(text, width, height) {
  return { width, height, codes: codesOfPlanes(await inflate(bytesOfBase64(text)), width, height) };
}

// A photograph as light: the sRGB curve undone (IEC 61966-2-1), 1.0 at its white.
const codesOfBytes = Uint16Array.from({ length: 256 }, (_, byte) => {
  const v = byte / 255;
  return codeOfFloat(v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
});

async function decodePhoto(text, width, height) {
  const blob = new Blob([bytesOfBase64(text)], { type: "image/jpeg" });
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none" });
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  const pixels = context.getImageData(0, 0, width, height).data;
  const codes = new Uint16Array(3 * width * height);
  for (let i = 0, j = 0; i < codes.length; j++) {
    codes[i++] = codesOfBytes[pixels[j++]];
    codes[i++] = codesOfBytes[pixels[j++]];
    codes[i++] = codesOfBytes[pixels[j++]];
  }
  return { width, height, codes };
}

const DIFFUSE_SIZE = [48, 24];
const GLOSSY_SIZE = [64, 32];

// The pictures of a layer: the map itself, and what white and rough balls reflect.
async function decodeLayer(layer) {
  const [data, diffuse, glossy] = document.getElementById(layer.block).textContent.trim().split(/\s+/);
  const decode = layer.photo ? decodePhoto : decodeRadiance;
  const [map, white, rough] = await Promise.all([
    decode(data, layer.width, layer.height),
    decodeRadiance(diffuse, ...DIFFUSE_SIZE),
    decodeRadiance(glossy, ...GLOSSY_SIZE),
  ]);
  return { map, diffuse: white, glossy: rough };
}

// The radiance of the pixel that a direction falls into.
function radianceAt(map, direction) {
  const [x, y, z] = direction;
  const u = Math.atan2(x, -z) / (2 * Math.PI) + 0.5;
  const v = 0.5 - Math.asin(Math.max(-1, Math.min(1, y))) / Math.PI;
  const column = Math.min(map.width - 1, Math.floor(u * map.width));
  const row = Math.min(map.height - 1, Math.floor(v * map.height));
  const at = 3 * (row * map.width + column);
  return [0, 1, 2].map((channel) => floatOfCode(map.codes[at + channel]));
}

function luminanceOf([red, green, blue]) {
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}
