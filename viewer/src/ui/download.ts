/** Has the browser keep a file. */
export function download(content: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  // the browser has taken it up by then
  setTimeout(() => {
    URL.revokeObjectURL(link.href);
  }, 60_000);
}
