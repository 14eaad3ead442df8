// SPDX-License-Identifier: BSD-3-Clause
// What a ray from the eye meets first: fitted bodies, and points of the clouds.
import { Matrix4, Quaternion, Vector3 } from 'three';

/** The fruit whose body a ray meets first, with its distance: [id, t] or null. */
export function bodyOnRay(fitted, origin, direction) {
  let best = null;
  for (const f of fitted) {
    const inverse = new Matrix4().compose(new Vector3(...f.center_world), new Quaternion(...f.body_orientation_world), new Vector3(...f.radii)).invert();
    const o = origin.clone().applyMatrix4(inverse), d = origin.clone().add(direction).applyMatrix4(inverse).sub(o);
    const a = d.dot(d), b = o.dot(d), c = o.dot(o) - 1, h = b * b - a * c;
    if (h < 0) continue;
    const t = (-b - Math.sqrt(h)) / a;
    if (t > 0 && (!best || t < best[1])) best = [f.id, t];
  }
  return best;
}

/**
 * The point of a cloud that a ray meets: of the points in the foremost surface, the one nearest to the ray.
 * @param shown (i) whether point i is on show   @param slope half the width of the ray per metre of distance
 * @returns {index, distance, at} or null
 */
export function pointOnRay(cloud, shown, origin, direction, slope) {
  const near = [], p = new Vector3(), { positions } = cloud;
  let first = Infinity;
  for (let i = 0; i < cloud.n; ++i) {
    p.set(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]).sub(origin);
    const t = p.dot(direction);
    if (t <= 0 || t > first + 2 * cloud.radius || !shown(i)) continue;
    const aside = p.addScaledVector(direction, -t).length();
    if (aside >= Math.max(cloud.radius, slope * t)) continue;
    near.push([i, t, aside]);
    first = Math.min(first, t);
  }
  const best = near.filter(([, t]) => t <= first + 2 * cloud.radius).reduce((a, b) => (!a || b[2] < a[2] ? b : a), null);
  return best && { index: best[0], distance: best[1], at: new Vector3(...positions.subarray(3 * best[0], 3 * best[0] + 3)) };
}
