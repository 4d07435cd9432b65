const still = (node) => { node.hidden = true; node.nextElementSibling.style.display = "block"; };

async function draw(node) {
  const figure = JSON.parse(document.getElementById(node.dataset.figure).textContent);
  const config = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"]};
  await Plotly.newPlot(node, figure.data, figure.layout, config);
}

/** Unpack the library, which stands in the page as base64 of gzip, and run it. */
async function load() {
  const packed = atob(document.getElementById("library").textContent);
  const bytes = Uint8Array.from(packed, (sign) => sign.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const script = document.createElement("script");
  script.textContent = await new Response(plain).text();
  document.head.append(script);
}

const plots = [...document.querySelectorAll(".plot")];
const drawn = load()
  .then(() => Promise.all(plots.map((node) => draw(node).catch(() => still(node)))), () => plots.forEach(still))
  .then(() => { document.documentElement.dataset.drawn = "yes"; });
