/** Loads the module, from beside this file unless told otherwise. Call it once, before anything else. */
export default function start(source?: string | URL | Request | Response | Promise<Response> | BufferSource | WebAssembly.Module): Promise<void>;

/** What counts for the error, and what is kept. */
export interface MeshOptions {
  /** Normals, three numbers a vertex. */
  normals?: Float32Array;
  /** Texture coordinates, two numbers a vertex. */
  uvs?: Float32Array;
  /** Colours, three or four numbers a vertex, 0 to 1. */
  colors?: Float32Array;
  /** A material for each triangle: their borders stay, and each is a group. */
  materials?: Uint32Array;
}

/** When to stop: at the first that is reached. Without any as far as it goes. */
export interface TargetOptions {
  /** Triangles. */
  triangles?: number;
  /** Share of the triangles, 0 to 1. */
  ratio?: number;
  /** Largest distance between the surfaces, in units of the positions. */
  error?: number;
}

/** What came of a simplification. Its arrays are copies. */
export interface Simplified {
  /** Three vertices of the input for every triangle that is left. */
  readonly indices: Uint32Array;
  /** The triangle of the input that every triangle was. */
  readonly triangles: Uint32Array;
  /** How far the surface is off, in units of the positions. */
  readonly error: number;
  /** Why it stopped. */
  readonly reason: 'target' | 'error' | 'nothing-legal' | 'guard';
  /** Gives its memory back at once, instead of when it is collected. */
  free(): void;
}

/**
 * Simplifies a mesh: positions, three numbers a vertex, and three indices a triangle. Vertices stay as they are, so all their attributes
 * can be used again with the new indices.
 *
 * @throws Error that says which number or option is wrong.
 */
export function simplify(positions: Float32Array, indices: Uint32Array, options?: MeshOptions & TargetOptions): Simplified;

export interface LodOptions extends MeshOptions, TargetOptions {
  /** `hierarchy` (default): fine where a camera needs it. `tom`: one level for the whole mesh, in less memory. */
  structure?: 'hierarchy' | 'tom';
  /** Most triangles that are drawn. */
  most?: number;
}

/** A mesh, and the level of detail that is drawn of it: indices over one vertex buffer, which is never written again. */
export class Lod {
  /** Builds all levels of detail. The targets say how far down they go. */
  constructor(positions: Float32Array, indices: Uint32Array, options?: LodOptions);

  /** The vertex of the input that each vertex is, once [arranged](Lod.arrange). */
  readonly order: Uint32Array;
  /** Puts the values of an attribute, `width` numbers a vertex, into the order that indices count in. */
  arrange<A extends Float32Array | Uint32Array | Int32Array | Uint16Array | Int16Array | Uint8Array | Int8Array | Uint8ClampedArray>(values: A, width: number): A;

  /**
   * Adds a camera of the next `adapt`: the matrix from object to eye, column-major, the eye looking along -z (`modelViewMatrix` of three.js); the
   * vertical field of view in radians; the picture's size in pixels; and how many pixels the surface may be off.
   */
  addView(objectToEye: Float32Array, fieldOfView: number, width: number, height: number, tolerance: number): void;
  /** Follows the cameras added since the last call, `seconds` after it. Whether other triangles are drawn than before. */
  adapt(seconds: number): boolean;

  /** Triangles that are drawn. */
  readonly triangles: number;
  /** Triangles at full resolution. */
  readonly fullTriangles: number;
  /** Groups of triangles: one for each material, at least one. */
  readonly groups: number;
  /** The material of a group. */
  material(group: number): number;
  /** Indices of the drawn triangles of a group, without a copy: use them before the next call of anything in this module. */
  indices(group?: number): Uint32Array;
  /** Where the indices of a group changed in the last `adapt`: pairs of first index and number of indices. */
  changed(group: number): Uint32Array;

  /** Gives its memory back at once, instead of when it is collected. */
  free(): void;
}
