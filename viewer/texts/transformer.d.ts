/** See transformer.js; what is given is wuchale's. */
interface Found {
  readonly msgs: readonly { readonly msgStr: readonly string[] }[];
}
export function transform(given: object): Promise<Found>;
