"""The jobs of the study: ``run`` of each file is what the rule of that name does.

Its arguments are the rule's params, inputs and outputs by their names; inputs named ``after`` are
only waited for. It returns what its sidecar states besides files, code and time. A file imports
what its job needs and no more: the hash of these imports decides what an edit reruns.
"""
