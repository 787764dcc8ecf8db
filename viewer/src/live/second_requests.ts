/** Asks the engine to lay the second scan elsewhere, to bring its segments, or to show none any more. */
import { apiAddress } from "./connection";

/** Lays it where a transform's file says; null: as its own file does. Throws why it was refused. */
export async function moveSecond(transform: File | null): Promise<void> {
  const place = new URL(apiAddress("/api/second/transform"));
  if (transform === null) {
    await asked(place, { method: "DELETE" });
  } else {
    place.searchParams.set("name", transform.name);
    await asked(place, { method: "PUT", body: transform });
  }
}

/** Adds segments of the second scan to the first, where the second lies now. Throws why they were refused. */
export async function bringSegments(file: File): Promise<void> {
  const place = new URL(apiAddress("/api/second/segments"));
  place.searchParams.set("name", file.name);
  await asked(place, { method: "PUT", body: file });
}

export async function removeSecond(): Promise<void> {
  await asked(new URL(apiAddress("/api/second")), { method: "DELETE" });
}

async function asked(place: URL, wanted: RequestInit): Promise<void> {
  const answer = await fetch(place, wanted);
  if (!answer.ok) {
    throw new Error(await answer.text());
  }
}
