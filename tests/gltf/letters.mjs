// What samples/letters.obj looks like from each side, told by its picture alone.

/** From where a side is seen: `theta` around +y from +z, `phi` down from +y, in degrees; `width`,
 *  `height` and `depth` are halves of the box's size across, along and towards the eye. */
export const sides = [
  { letter: 'F', theta: 0, phi: 90, width: 1.2, height: 0.8, depth: 1, column: 0, row: 0 },
  { letter: 'B', theta: 180, phi: 90, width: 1.2, height: 0.8, depth: 1, column: 1, row: 0 },
  { letter: 'L', theta: 90, phi: 90, width: 1, height: 0.8, depth: 1.2, column: 0, row: 1 },
  { letter: 'R', theta: -90, phi: 90, width: 1, height: 0.8, depth: 1.2, column: 1, row: 1 },
  { letter: 'U', theta: 0, phi: 0, width: 1.2, height: 1, depth: 0.8, column: 0, row: 2 },
  { letter: 'D', theta: 0, phi: 180, width: 1.2, height: 1, depth: 0.8, column: 1, row: 2 },
];

const kColumns = 2, kRows = 3;

/** A colour's kind, whatever the light: black, or its channels against the brightest. */
function kind([r, g, b]) {
  const most = Math.max(r, g, b);
  return most < 50 ? [0, 0, 0] : [r / most, g / most, b / most];
}

const apart = (a, b) => Math.max(...a.map((v, i) => Math.abs(v - b[i])));

/** Compares what is seen at points of a side, `spot(x, y)` = [r, g, b] with y up, to the image;
 *  returns what is wrong. Points near a change of colour in the image are passed over. */
export function mismatches(side, image, spot) {
  const w = image.width / kColumns, h = image.height / kRows;
  const texel = (x, y) => {
    const at = Math.floor(y) * image.width + Math.floor(x);
    return Array.from(image.data.subarray(4 * at, 4 * at + 3));
  };
  let points = 0, wrong = 0;
  for (let i = 0; i < 32; ++i)
    for (let j = 0; j < 24; ++j) {
      const x = side.column * w + ((i + 0.5) / 32) * w, y = side.row * h + ((j + 0.5) / 24) * h;
      const wanted = texel(x, y);
      const clear = [-5, 5].every((dx) => [-5, 5].every((dy) => {
        const [a, b] = [x + dx, y + dy];
        return a >= 0 && b >= 0 && a < image.width && b < image.height && apart(texel(a, b), wanted) === 0;
      }));
      if (!clear) continue;
      ++points;
      const seen = spot((2 * (i + 0.5) / 32 - 1) * side.width, (1 - 2 * (j + 0.5) / 24) * side.height);
      // Light that is mirrored pales a colour; the six of the sides are 0.5 and more apart.
      wrong += apart(kind(seen), kind(wanted)) > 0.35 ? 1 : 0;
    }
  if (points < 300) return [`side ${side.letter}: only ${points} points of the image can be judged`];
  return wrong > 0.02 * points ? [`side ${side.letter}: ${wrong} of ${points} points have another colour`] : [];
}

/** What is wrong with the judgement: the same picture mirrored or turned must not pass. */
export function tooMild(side, image, spot) {
  const others = { mirrored: (x, y) => spot(-x, y), 'upside down': (x, y) => spot(x, -y), turned: (x, y) => spot(-x, -y) };
  return Object.entries(others).filter(([, other]) => mismatches(side, image, other).length === 0)
    .map(([name]) => `side ${side.letter}: would pass ${name} as well`);
}
