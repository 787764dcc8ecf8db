/**
 * Hands on the value before as long as nothing that matters in it has changed, so that whoever
 * compares values by identity has nothing to do again.
 */
export class KeepEqual<Value> {
  private last: { readonly key: string; readonly value: Value } | null = null;

  /** @param key tells all that matters of the value. */
  of(value: Value, key: string): Value {
    if (this.last?.key !== key) {
      this.last = { key, value };
    }
    return this.last.value;
  }
}
