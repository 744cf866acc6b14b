// What the page says of its maps, as data.

function byId(id) {
  return document.getElementById(id);
}

const { maps: MAPS, palette: PALETTE_TEXT } = JSON.parse(byId("report-data").textContent);
const PALETTE = bytesOfBase64(PALETTE_TEXT);
