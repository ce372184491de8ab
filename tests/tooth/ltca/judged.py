"""The certificate of a single contact."""

import numpy as np

from loadshare.tooth.contact.certificate import ContactCertificate, certify_contacts
from loadshare.tooth.contact.problem import ToothContact


def certify_contact(problem: ToothContact, load, force, approach) -> ContactCertificate:
    """Return the verdict on forces (N,) [N] and the approach [m] claimed for a load [N]."""
    claimed = np.array([load]), force[None], np.array([approach])
    return certify_contacts(problem.alone, *claimed)[0]
