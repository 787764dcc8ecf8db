/** See pseudo.js. */
export const pseudo: string;
export function inPseudo(text: string): string;
