// The ways in which values along a ray become one colour. Keep in sync with core/appearance/optics.ts.
#define SHADED 0
#define COMPOSITE 1
#define ABSORPTION 2
#define EMISSION 3
#define MIP 4
#define MINIP 5
#define AVERAGE 6
#define ISO 7
