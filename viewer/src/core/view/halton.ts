/** Numbers that cover 0..1 evenly, however many of them are taken. Source: Halton (1960). */
export function halton(index: number, base: number): number {
  let result = 0;
  let share = 1;
  for (let i = index; i > 0; i = Math.floor(i / base)) {
    share /= base;
    result += share * (i % base);
  }
  return result;
}
