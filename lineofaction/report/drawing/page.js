const drawn = [];
for (const node of document.querySelectorAll(".plot")) {
  const figure = JSON.parse(document.getElementById(node.dataset.figure).textContent);
  const config = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"]};
  const fall = () => { node.hidden = true; node.nextElementSibling.style.display = "block"; };
  drawn.push(Plotly.newPlot(node, figure.data, figure.layout, config).catch(fall));
}
Promise.all(drawn).then(() => { document.documentElement.dataset.drawn = "yes"; });
