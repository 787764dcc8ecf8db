/**
 * What the page writes over the 3-D view, drawn into a picture of it at any size: measured values, letters of the
 * patient's sides and the scale bar, where and as they stand on the page.
 */

/** Elements of the view that are a part of its picture. */
const written = "text.number, .edge, .scale > .number";
const bars = ".scale > .bar";

/** What the page writes over a view, as it is now; drawn by the returned function. */
export function overlayOf(view: Element): (context: CanvasRenderingContext2D) => void {
  const { left, top, width } = view.getBoundingClientRect();
  const texts = [...view.querySelectorAll(written)].map(textOf);
  const lines = [...view.querySelectorAll(bars)].map((bar) => ({
    rect: bar.getBoundingClientRect(),
    colour: getComputedStyle(bar).borderBottomColor,
  }));
  return (context) => {
    context.save();
    context.scale(context.canvas.width / width, context.canvas.width / width);
    context.translate(-left, -top);
    for (const text of texts) {
      write(context, text);
    }
    for (const { rect, colour } of lines) {
      drawBar(context, rect, colour);
    }
    context.restore();
  };
}

interface Written {
  readonly text: string;
  readonly font: string;
  readonly colour: string;
  readonly opacity: number;
  readonly rect: DOMRect;
}

function textOf(element: Element): Written {
  const style = getComputedStyle(element);
  const rect = element.getBoundingClientRect();
  // the page may be enlarged, and a font is not told so
  const zoom = Number(style.zoom) || 1;
  const size = parseFloat(style.fontSize) * zoom;
  return {
    text: element.textContent,
    font: `${style.fontWeight} ${String(size)}px ${style.fontFamily}`,
    colour: element instanceof SVGElement ? style.fill : style.color,
    opacity: Number(element.closest("g[opacity]")?.getAttribute("opacity") ?? 1),
    rect,
  };
}

function write(context: CanvasRenderingContext2D, { text, font, colour, opacity, rect }: Written): void {
  context.font = font;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.globalAlpha = opacity;
  context.lineJoin = "round";
  context.lineWidth = 3;
  context.strokeStyle = "#000";
  context.fillStyle = colour;
  const [x, y] = [rect.x + rect.width / 2, rect.y + rect.height / 2];
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
  context.globalAlpha = 1;
}

/** A line with ends that stand up, on a dark halo. */
function drawBar(context: CanvasRenderingContext2D, { left, right, top, bottom }: DOMRect, colour: string): void {
  context.beginPath();
  context.moveTo(left + 0.5, top);
  context.lineTo(left + 0.5, bottom - 0.5);
  context.lineTo(right - 0.5, bottom - 0.5);
  context.lineTo(right - 0.5, top);
  for (const [style, width] of [["#000", 3], [colour, 1]] as const) {
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
  }
}
