// Where on the map the mouse is.

const byId = (id) => document.getElementById(id);

export function listenToPointer(canvas, view) {
  const where = byId("where");
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerType !== "mouse") return;
    const { x, y } = view.toWorld(event.offsetX, event.offsetY);
    where.textContent = `${signed(x)}, ${signed(y)} m`;
    where.hidden = false;
  });
  canvas.addEventListener("pointerleave", () => (where.hidden = true));
}

function signed(number) {
  return number.toFixed(2).replace(/^-(?=0\.00$)/, "").replace("-", "−");
}
