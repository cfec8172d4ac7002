#!/usr/bin/python3
"""Initial state of the shear cell: writes a LIGGGHTS read_data file.
   usage: gen_shear.py out.data seed [N] [width_in_d] [phi0] [Vw]
   type 1 = bulk (N particles, 100 discrete diameters 0.8d..1.2d, equal numbers),
   type 2 = bottom wall, type 3 = top wall (square lattices of touching grains, diameter d).
   Method: random positions at packing fraction phi0 between the walls, then overlaps are
   removed by pushing overlapping pairs apart (frictionless relaxation)."""
import sys, numpy as np
from scipy.spatial import cKDTree
out=sys.argv[1]; seed=int(sys.argv[2]); N=int(sys.argv[3]) if len(sys.argv)>3 else 7400
nL=int(sys.argv[4]) if len(sys.argv)>4 else 12
phi0=float(sys.argv[5]) if len(sys.argv)>5 else 0.57
d=0.8e-3; L=nL*d; rho=2500.; Vw=float(sys.argv[6]) if len(sys.argv)>6 else 2.0
rng=np.random.default_rng(seed)
nd=100
dia=np.resize(np.linspace(0.8*d,1.2*d,nd),N); rng.shuffle(dia)
V=np.pi/6*(dia**3).sum(); H0=V/(L*L*phi0)
print("N",N,"mean d/d0",dia.mean()/d,"solid height/d",V/(L*L)/d,"H0/d",H0/d)
g=(np.arange(nL)+0.5)*d
gx,gy=np.meshgrid(g,g,indexing='ij')
bot=np.c_[gx.ravel(),gy.ravel(),np.full(nL*nL,-0.5*d)]
top=np.c_[gx.ravel(),gy.ravel(),np.full(nL*nL,H0+0.5*d)]
nw=nL*nL
x=rng.random((N,3))*[L,L,H0-d]+[0,0,0.5*d]
X=np.r_[x,bot,top]; D=np.r_[dia,np.full(2*nw,d)]; R=D/2
mob=np.arange(len(X))<N
for it in range(4000):
    X[:,:2]%=L
    Xs=X.copy(); Xs[:,2]+=10*d
    t=cKDTree(Xs,boxsize=[L,L,1e3*d])
    p=t.query_pairs(1.2*d,output_type='ndarray')
    dx=X[p[:,1]]-X[p[:,0]]
    dx[:,:2]-=L*np.round(dx[:,:2]/L)
    r=np.sqrt((dx**2).sum(1)); ov=R[p[:,0]]+R[p[:,1]]-r
    keep=(ov>0)&(mob[p[:,0]]|mob[p[:,1]])
    p=p[keep];dx=dx[keep];r=r[keep];ov=ov[keep]
    mx=ov.max()/d if len(ov) else 0
    if it%200==0: print(it,len(ov),mx)
    if mx<2e-4: break
    s=0.42*(ov+2e-5*d)[:,None]*dx/r[:,None]
    wi=np.where(mob[p[:,1]],1.,2.)[:,None]; wj=np.where(mob[p[:,0]],1.,2.)[:,None]
    for k in range(3):
        X[:,k]+=np.where(mob,np.bincount(p[:,1],(s*wj)[:,k],len(X))-np.bincount(p[:,0],(s*wi)[:,k],len(X)),0)
    X[:N,2]=np.clip(X[:N,2],0.1*d,H0-0.1*d)
print("done",it,"max overlap/d",mx)
X[:,:2]%=L
v=np.zeros_like(X); v[:,0]=Vw*np.exp(-(H0-X[:,2])/(7.5*d)); v[N:N+nw]=0; v[N+nw:]=[Vw,0,0]
typ=np.r_[np.ones(N,int),np.full(nw,2),np.full(nw,3)]
with open(out,'w') as f:
    f.write("shear cell gen_shear.py seed %d\n\n%d atoms\n3 atom types\n\n"%(seed,len(X)))
    f.write("0 %.10g xlo xhi\n0 %.10g ylo yhi\n%.10g %.10g zlo zhi\n\nAtoms\n\n"%(L,L,-2*d,H0+8*d))
    for i in range(len(X)):
        f.write("%d %d %.9g %g %.10g %.10g %.10g\n"%(i+1,typ[i],D[i],rho,*X[i]))
    f.write("\nVelocities\n\n")
    for i in range(len(X)): f.write("%d %.9g %.9g %.9g 0 0 0\n"%(i+1,*v[i]))
