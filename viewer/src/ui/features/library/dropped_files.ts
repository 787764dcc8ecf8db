/** Files of a drop or of a chooser, with the folders that they lie in. */
import type { GivenFile } from "../../../core/library/library";

/** Whether what is dragged over the page are files. */
export function holdsFiles(event: DragEvent): boolean {
  return event.dataTransfer?.types.includes("Files") ?? false;
}

/** All files of a drop, those in folders too. */
export async function filesDropped(transfer: DataTransfer): Promise<GivenFile[]> {
  // the list is empty once the event is over
  const entries = [...transfer.items].flatMap((item) => item.webkitGetAsEntry() ?? []);
  return (await Promise.all(entries.map(filesOf))).flat();
}

export function filesChosen(files: FileList | null): GivenFile[] {
  return [...(files ?? [])].map((file) => ({
    name: file.webkitRelativePath === "" ? file.name : file.webkitRelativePath,
    file,
  }));
}

async function filesOf(entry: FileSystemEntry): Promise<GivenFile[]> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => {
      (entry as FileSystemFileEntry).file(resolve, reject);
    });
    return [{ name: entry.fullPath.replace(/^\//, ""), file }];
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: GivenFile[] = [];
  // a hundred at a time, until there are none
  for (;;) {
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => {
      reader.readEntries(resolve, reject);
    });
    if (some.length === 0) {
      return found;
    }
    found.push(...(await Promise.all(some.map(filesOf))).flat());
  }
}
