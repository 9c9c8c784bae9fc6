// Solids as triangles: positions are unit normals' own where they can be, and indices.

/** A sphere of radius 1. */
function sphereMesh(around = 32, along = 16) {
  const positions = [];
  const indices = [];
  for (let i = 0; i <= along; i += 1) {
    const polar = (Math.PI * i) / along;
    for (let j = 0; j <= around; j += 1) {
      const azimuth = (2 * Math.PI * j) / around;
      positions.push(Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar));
    }
  }
  for (let i = 0; i < along; i += 1) {
    for (let j = 0; j < around; j += 1) {
      const at = i * (around + 1) + j;
      indices.push(at, at + around + 1, at + 1, at + 1, at + around + 1, at + around + 2);
    }
  }
  return { positions, normals: positions, indices };
}

/** A box with edges of 1. */
function boxMesh() {
  const positions = [];
  const normals = [];
  const indices = [];
  for (let axis = 0; axis < 3; axis += 1) {
    for (const side of [-1, 1]) {
      const first = positions.length / 3;
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const corner = [0, 0, 0];
        const normal = [0, 0, 0];
        corner[axis] = side / 2;
        corner[(axis + 1) % 3] = (side * a) / 2;
        corner[(axis + 2) % 3] = b / 2;
        normal[axis] = side;
        positions.push(...corner);
        normals.push(...normal);
      }
      indices.push(first, first + 1, first + 2, first, first + 2, first + 3);
    }
  }
  return { positions, normals, indices };
}

/** A cylinder along z of radius 1 and height 1. */
function cylinderMesh(around = 32) {
  const positions = [];
  const normals = [];
  const indices = [];
  const ring = (z, radial, up) => {
    for (let j = 0; j <= around; j += 1) {
      const azimuth = (2 * Math.PI * j) / around;
      const [x, y] = [Math.cos(azimuth), Math.sin(azimuth)];
      positions.push(x, y, z);
      normals.push(radial * x, radial * y, up);
    }
  };
  ring(-0.5, 1, 0);
  ring(0.5, 1, 0);
  for (let j = 0; j < around; j += 1) {
    indices.push(j, j + 1, around + 1 + j, around + 1 + j, j + 1, around + 2 + j);
  }
  for (const up of [-1, 1]) {
    const first = positions.length / 3;
    ring(0.5 * up, 0, up);
    positions.push(0, 0, 0.5 * up);
    normals.push(0, 0, up);
    const centre = first + around + 1;
    for (let j = 0; j < around; j += 1) {
      indices.push(centre, ...(up > 0 ? [first + j, first + j + 1] : [first + j + 1, first + j]));
    }
  }
  return { positions, normals, indices };
}
