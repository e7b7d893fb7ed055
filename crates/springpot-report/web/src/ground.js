/** @file The ground: a grid that fades out, the axes on it, and what catches shadows. */

import { Color, DoubleSide, Mesh, PlaneGeometry, ShaderMaterial, ShadowMaterial, Vector2, Group } from 'three';
import { step } from './format.js';

export class Ground {
  constructor() {
    this.group = new Group();
    const geometry = new PlaneGeometry(1, 1);
    this.material = new ShaderMaterial({
      transparent: true, depthWrite: false, side: DoubleSide,
      uniforms: { spacing: { value: 0.1 }, reach: { value: 1 }, middle: { value: new Vector2() }, line: { value: new Color() }, strength: { value: 1 } },
      vertexShader: `varying vec2 place; void main() { vec4 world = modelMatrix * vec4(position, 1.0); place = world.xy; gl_Position = projectionMatrix * viewMatrix * world; }`,
      fragmentShader: `
        uniform float spacing, reach, strength; uniform vec2 middle; uniform vec3 line; varying vec2 place;
        float grid(float every, float width) {
          vec2 at = place / every, wide = max(fwidth(at), 1e-6);
          vec2 near = abs(fract(at - 0.5) - 0.5) / wide;
          // Lines closer than a few pixels would only shimmer.
          return (1.0 - min(min(near.x, near.y) / width, 1.0)) * clamp(1.4 - 3.0 * max(wide.x, wide.y), 0.0, 1.0);
        }
        void main() {
          float fade = 1.0 - smoothstep(0.25, 1.0, length(place - middle) / reach);
          float a = max(0.3 * grid(spacing, 0.9), 0.62 * grid(5.0 * spacing, 1.0));
          gl_FragColor = vec4(line, a * fade * fade * strength);
          #include <colorspace_fragment>
        }`,
    });
    this.grid = new Mesh(geometry, this.material);
    this.grid.renderOrder = -2;
    this.shadow = new Mesh(geometry, new ShadowMaterial({ opacity: 0.2, depthWrite: false }));
    this.shadow.receiveShadow = true;
    this.shadow.renderOrder = -1;
    this.group.add(this.grid, this.shadow);
    this.spacing = 0.1;
  }

  /** @param {number[]} middle @param {number} radius of the motion @param {number} z */
  fit(middle, radius, z) {
    this.spacing = step(radius, 9);
    this.material.uniforms.spacing.value = this.spacing;
    this.material.uniforms.reach.value = 4.2 * radius;
    this.material.uniforms.middle.value.set(middle[0], middle[1]);
    for (const mesh of [this.grid, this.shadow]) {
      mesh.scale.setScalar(9 * radius);
      mesh.position.set(middle[0], middle[1], z - 1e-4 * radius);
    }
  }

  /** @param {boolean} dark */
  look(dark) {
    this.material.uniforms.line.value.set(dark ? '#8fa0b5' : '#5c6b7e');
    this.material.uniforms.strength.value = dark ? 0.62 : 0.7;
    this.shadow.material.opacity = dark ? 0.42 : 0.17;
  }
}
