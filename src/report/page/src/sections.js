// The sections below the first screen, in their order.
import { agreementSection } from './agreement.js';
import { errorSection } from './errors.js';
import { forceSection } from './force.js';
import { parameterSection } from './parameters.js';
import { physicsSection } from './physics.js';
import { planSection } from './plan.js';
import { provenanceSection } from './provenance.js';
import { reconstructionSection } from './reconstruction.js';
import { runsSection } from './runs.js';
import { ablationSection, intervalsSection, table1Section, trialsSection } from './studies.js';
import { validationSection } from './validation.js';

export function sections(context) {
  return [runsSection, reconstructionSection, errorSection, forceSection, physicsSection, planSection, parameterSection,
    agreementSection, table1Section, ablationSection, trialsSection, intervalsSection, provenanceSection].map((build) => build(context)).filter(Boolean);
}

// Sections that unpack arrays first, each with the section before which it belongs.
export async function lateSections(context) {
  const part = await validationSection(context);
  return part ? [{ before: 'provenance', part }] : [];
}
